// Judges how well the tip is known by the whole chain.
#pragma once

#include <string>
#include <vector>

#include "calibration/uncertainty/budget_summary.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

/// A part that is left out of the budget.
struct UnknownPart {
  std::string part, reason;
};

/// Returns the part to improve first: the largest of the total, in words.
std::string BudgetAdvice(const std::vector<BudgetPartSize>& parts);

/// Judges `parts` as SummariseBudgets gives them, over `frames` frames.
CalibrationVerdict JudgeBudget(const std::vector<BudgetPartSize>& parts,
                               const std::vector<UnknownPart>& not_known, std::size_t frames);

}  // namespace flextip
