#include "control/supervision/jerk_filter.h"

#include <algorithm>
#include <cmath>

namespace flextip {

double JerkFilter::LeastJerk(double max_acceleration_m_s2, double rate_hz) {
  return 2.0 * max_acceleration_m_s2 * rate_hz / static_cast<double>(kLongest);
}

JerkFilter::JerkFilter(const RateLimits& rates, double rate_hz) {
  last_.fill(Eigen::Vector3d::Zero());
  if (rates.max_jerk_m_s3 <= 0.0 || rates.max_acceleration_m_s2 <= 0.0) return;
  const double cycles = 2.0 * rates.max_acceleration_m_s2 * rate_hz / rates.max_jerk_m_s3;
  length_ =
      static_cast<std::size_t>(std::clamp(std::ceil(cycles), 1.0, static_cast<double>(kLongest)));
}

void JerkFilter::Reset(const Eigen::Vector3d& p_RW) { last_.fill(p_RW); }

Eigen::Vector3d JerkFilter::Next(const Eigen::Vector3d& p_RW) {
  if (length_ == 1) return p_RW;
  last_[next_] = p_RW;
  next_ = (next_ + 1) % length_;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < length_; ++i) sum += last_[i];
  return sum / static_cast<double>(length_);
}

}  // namespace flextip
