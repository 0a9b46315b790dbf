// The files of flextip collar.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/figure.h"
#include "targets/collar/accuracy.h"
#include "targets/collar/design.h"

namespace flextip {

/// summary.json's keys beside those of every command.
nlohmann::json CollarSummary(const CollarDesign& design, const ViewingConditions& conditions,
                             const std::vector<AccuracyAtDistance>& accuracy);
/// accuracy.csv.
std::string AccuracyTable(const std::vector<AccuracyAtDistance>& accuracy);
/// The tip's error and the direction's against the distance.
std::vector<report::Figure> AccuracyFigures(const std::vector<AccuracyAtDistance>& accuracy);

}  // namespace flextip
