// A limit of the commands' jerk.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include "control/supervision/supervisor_options.h"
#include "core/state_text.h"

namespace flextip {

/// Limits the jerk of commands whose acceleration is limited: by the mean over the last
/// 2 a / (j dt) of them, since an acceleration that leaps by 2 a then takes so many cycles. A mean
/// of places does not leave their hull, so that a place which is reached without overshoot still
/// is, half the filter's time later. Fixed size, allocates nothing.
class JerkFilter {
 public:
  static constexpr std::size_t kLongest = 64;  ///< cycles

  /// Returns the least jerk (m/s^3) that the longest filter keeps.
  static double LeastJerk(double max_acceleration_m_s2, double rate_hz);

  /// Takes the limits and the cycles' rate. Without a limit of jerk, or of acceleration, commands
  /// go through as they are. A jerk below LeastJerk is kept as well as the longest filter can.
  JerkFilter(const RateLimits& rates, double rate_hz);

  bool Limits() const { return length_ > 1; }

  /// Takes `p_RW` (R, m) as where the command stands.
  void Reset(const Eigen::Vector3d& p_RW);

  /// Returns the command for one within the limit of acceleration.
  Eigen::Vector3d Next(const Eigen::Vector3d& p_RW);

  void VisitState(StateText& state) {
    state(next_);
    state(last_);
    next_ %= length_;
  }

 private:
  std::size_t length_ = 1, next_ = 0;
  std::array<Eigen::Vector3d, kLongest> last_;
};

}  // namespace flextip
