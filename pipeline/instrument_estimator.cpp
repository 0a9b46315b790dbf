#include "pipeline/instrument_estimator.h"

namespace flextip {

void AddLengthDoubt(const InstrumentModel& model, ShaftEstimate& estimate) {
  const Eigen::Vector3d along = model.LengthSd() * estimate.d_RE;
  estimate.p_RE_covariance_m2 += along * along.transpose();
}

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
