// What `calibrate tip` writes: calibration.yaml, the summary, residuals.csv and the figures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/tip/pivot.h"
#include "report/figure.h"

namespace flextip {

/// `tip_name` as in calibration.yaml: "tip.p_WE", "tip.p_SE" or "tags0.p_E"; `body`: its frame,
/// "W".
nlohmann::json TipSummary(const std::vector<PivotPose>& poses, const PivotResult& result,
                          const std::string& tip_name, const std::string& body);

/// A row a pose, in mm.
std::string TipResidualTable(const std::vector<PivotPose>& poses, const PivotResult& result);

std::vector<report::Figure> TipFigures(const std::vector<PivotPose>& poses,
                                       const PivotResult& result);

}  // namespace flextip
