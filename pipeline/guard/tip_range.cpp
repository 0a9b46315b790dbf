#include "pipeline/guard/tip_range.h"

namespace flextip {

TipRange::TipRange(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                   const Eigen::Vector3d& gravity_m_s2, const TipRangeOptions& options)
    : options_(options),
      by_sensors_(instrument, p_RP, gravity_m_s2, {.force_prior_units = options.force_units}) {}

std::optional<TipPrediction> TipRange::At(TimeNs t_ns,
                                          const std::optional<Measurements>& measured) {
  auto tip = by_sensors_.Predict(t_ns, measured);
  if (!tip) return tip;
  const double turn = options_.registration_rad, shift = options_.registration_m;
  tip->covariance.topLeftCorner<3, 3>() += turn * turn * Eigen::Matrix3d::Identity();
  tip->covariance.bottomRightCorner<3, 3>() += shift * shift * Eigen::Matrix3d::Identity();
  return tip;
}

}  // namespace flextip
