// What `calibrate tip` writes: calibration.yaml, the summary, residuals.csv and the figures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/verdict.h"
#include "calibration/tip/pivot.h"
#include "recording/calibrations/file.h"
#include "report/figure.h"

namespace flextip {

/// `tip_name` as in calibration.yaml: "tip.p_WE", "tip.p_SE" or "tags0.p_E".
Calibration TipCalibration(const PivotResult& result, const std::string& tip_name);

/// The advice in words, with frame `body` ("W").
std::string AdviceText(const PivotResult& result, const std::string& body);

nlohmann::json TipSummary(const std::vector<PivotPose>& poses, const PivotResult& result,
                          const std::string& tip_name, const std::string& body);

CalibrationVerdict TipVerdict(const PivotResult& result, const std::string& tip_name,
                              const std::string& body);

/// A row a pose, in mm.
std::string TipResidualTable(const std::vector<PivotPose>& poses, const PivotResult& result);

std::vector<report::Figure> TipFigures(const std::vector<PivotPose>& poses,
                                       const PivotResult& result);

}  // namespace flextip
