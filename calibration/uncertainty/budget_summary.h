// Budgets of many frames together: each part's size, and the calibrations they need.
#pragma once

#include <string>
#include <vector>

#include "calibration/uncertainty/error_budget.h"
#include "core/time_series.h"
#include "recording/calibrations/file.h"

namespace flextip {

using TimedBudget = Sample<TipBudget>;

/// Root mean square over the frames.
struct BudgetPartSize {
  std::string name;  ///< as in BudgetPart, or "total"
  double depth_mm = 0.0, across_mm = 0.0;
  bool in_total = true;

  bool IsTotal() const { return name == "total"; }
};

/// Returns the parts of `budget` and, last, their total.
std::vector<BudgetPart> PartsWithTotal(const TipBudget& budget);

/// Returns the size of every part, the largest first, the total last.
std::vector<BudgetPartSize> SummariseBudgets(const std::vector<TimedBudget>& budgets);

/// A part whose calibration is missing.
struct MissingCalibration {
  std::string part, parameter;  ///< "lens", "cam0.intrinsics"
};

/// The covariances that calibrations state of the chain from lens to tip.
struct StatedChain {
  ChainCovariance covariance;
  double stiffness_sd_Nm2 = 0.0;  ///< 0: not known
  std::vector<MissingCalibration> missing;
};

/// Gathers the covariances; of several calibrations with the same entry the last counts, as for the
/// values.
StatedChain GatherChain(const std::vector<const Calibration*>& calibrations);

}  // namespace flextip
