// What calibrate budget writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/output.h"
#include "calibration/verdict/budget.h"

namespace flextip {

/// RMS over the frames, in words: a line a part, the largest first.
std::string BudgetText(const std::vector<TimedBudget>& budgets);

/// budget.csv, figures.json, summary.json, report.html; and the folder in its place.
void WriteBudgetResults(OutputFolder& output, const std::vector<TimedBudget>& budgets,
                        const std::vector<UnknownPart>& not_known,
                        const nlohmann::json& calibrations);

}  // namespace flextip
