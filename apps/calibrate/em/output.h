// What `calibrate em` writes: calibration.yaml, the summary, residuals.csv and the figures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/verdict.h"
#include "calibration/em/em_calibration.h"
#include "recording/calibrations/file.h"
#include "report/figure.h"

namespace flextip {

Calibration EmFileOf(const EmResult& result);

nlohmann::json EmSummary(const std::vector<EmPair>& pairs, const EmResult& result);

/// That sensor and reference are not of one time; empty where they may be.
std::string LagText(const EmResult& result);

CalibrationVerdict EmVerdict(const EmResult& result);

/// A row a sample, in mm.
std::string EmResidualTable(const std::vector<EmPair>& pairs, const EmResult& result);

/// Residuals over time; error vectors before and after, from above and from the side.
std::vector<report::Figure> EmFigures(const std::vector<EmPair>& pairs, const EmResult& result);

}  // namespace flextip
