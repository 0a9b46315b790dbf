// What calibrate budget writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/output.h"
#include "calibration/uncertainty/error_budget.h"
#include "core/time_series.h"

namespace flextip {

using TimedBudget = Sample<TipBudget>;

/// A part that is left out of the budget.
struct NotKnown {
  std::string part, reason;
};

/// RMS over the frames, in words: a line a part, the largest first.
std::string BudgetText(const std::vector<TimedBudget>& budgets);

/// budget.csv, figures.json, summary.json, report.html; and the folder in its place.
void WriteBudgetResults(OutputFolder& output, const std::vector<TimedBudget>& budgets,
                        const std::vector<NotKnown>& not_known, const nlohmann::json& calibrations);

}  // namespace flextip
