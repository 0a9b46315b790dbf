// Judges whether the estimates of a recording hold: the head of estimate's page.
#pragma once

#include "core/judgement.h"
#include "core/time_series.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

/// What the estimates of a recording say together.
struct EstimateTotals {
  int samples = 0, ok = 0, unobservable = 0, not_converged = 0, bad_input = 0;
  double chi2_per_measurement = 0.0;  ///< of all samples together; 0 where nothing was measured
  /// Medians over the samples that are ok, of the standard deviation (root of the mean variance of
  /// an axis): the tip's place (m), the tip's force across and along the shaft (N).
  double tip_sd_m = 0.0, force_across_sd_N = 0.0, force_along_sd_N = 0.0;
};

EstimateTotals TotalsOf(const Series<ShaftEstimate>& estimates);

/// Judges totals: not found where no sample could be estimated, or where the misfit is so large
/// that the sensors contradict each other; to be used with care where a part of the samples failed
/// or the misfit is beyond the stated noise.
Judgement JudgeEstimates(const EstimateTotals& totals);

}  // namespace flextip
