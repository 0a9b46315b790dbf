// The estimator of a run: of one sample, or over a window of samples.
#pragma once

#include <optional>

#include "estimation/instrument_model.h"
#include "estimation/shaft_estimator.h"
#include "estimation/window_estimator.h"

namespace flextip {

/// Adds what `model` does not know of the instrument's length to the tip's covariance.
void AddLengthDoubt(const InstrumentModel& model, ShaftEstimate& estimate);

class InstrumentEstimator {
 public:
  /// Takes `window_samples`, the number of samples that share the port's shift; 0: each sample by
  /// itself.
  explicit InstrumentEstimator(const EstimatorOptions& options, int window_samples = 0);

  /// Fits the latest sample; allocates nothing.
  ShaftEstimate Update(const Measurements& measurements, const ShaftChange& change = {});

  /// Returns the window's estimate of the last update; null without a window and before the first.
  const WindowEstimate* Window() const { return window_estimate_ ? &*window_estimate_ : nullptr; }

  /// Visits what the next update starts from; the last one's result is not kept.
  void VisitState(StateText& state) {
    state(single_);
    if (window_) state(*window_);
  }

 private:
  ShaftEstimator single_;
  std::optional<WindowEstimator> window_;
  std::optional<WindowEstimate> window_estimate_;
};

}  // namespace flextip
