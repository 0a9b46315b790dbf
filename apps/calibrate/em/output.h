// The files of `calibrate em`: the summary, residuals.csv and the figures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/em/em_calibration.h"
#include "report/figure.h"

namespace flextip {

nlohmann::json EmSummary(const std::vector<EmPair>& pairs, const EmResult& result);

/// A row a sample, in mm.
std::string EmResidualTable(const std::vector<EmPair>& pairs, const EmResult& result);

/// Residuals over time; error vectors before and after, from above and from the side.
std::vector<report::Figure> EmFigures(const std::vector<EmPair>& pairs, const EmResult& result);

}  // namespace flextip
