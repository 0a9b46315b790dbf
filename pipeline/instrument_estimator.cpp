#include "pipeline/instrument_estimator.h"

namespace flextip {

InstrumentEstimator::InstrumentEstimator(const EstimatorOptions& options, int window_samples)
    : single_(options) {
  if (window_samples > 0) window_.emplace(WindowOptions{options, window_samples});
}

ShaftEstimate InstrumentEstimator::Update(const Measurements& measurements,
                                          const ShaftChange& change) {
  if (!window_) return single_.Update(measurements, change);
  window_estimate_ = window_->Update(measurements, change);
  return window_estimate_->shaft;
}

}  // namespace flextip
