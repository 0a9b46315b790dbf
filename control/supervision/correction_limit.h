// How far a controller may correct the tip in a picture's time.
#pragma once

#include <Eigen/Dense>

#include "control/supervision/rate_limits.h"
#include "core/state_text.h"

namespace flextip {

inline constexpr double kVideo_hz = 30.0;  ///< of tips that are seen

/// How far commands may move the tip (m): across the goal's motion, and along it beyond that motion
/// or back.
struct CorrectionLimits {
  double across_m = 0.0, along_m = 0.0;
};

/// Limits what commands of a picture's time add up to. Faster cycles may each do as much as long as
/// they do not go on in one direction: noise does not. Fixed size, allocates nothing.
class CorrectionLimit {
 public:
  /// Each cycle stands for itself.
  CorrectionLimit() = default;
  /// `rate_hz`: of the cycles; up to that of video each stands for itself, too.
  explicit CorrectionLimit(double rate_hz);

  /// Returns `p_wish`, drawn to `p_RW` so far that, by the Jacobian `J` (d tip / d wrist), the tip
  /// keeps within `limits`. `way`: the goal's motion in this cycle; where it is zero, every
  /// direction is across. All of `p_wish` where `J` is singular or not finite.
  Limited Limit(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_wish,
                const Eigen::Matrix3d& J, const Eigen::Vector3d& way,
                const CorrectionLimits& limits);

  void VisitState(StateText& state) { state(corrected_m_); }

 private:
  double keeps_ = 0.0;  // of what was corrected, from cycle to cycle
  Eigen::Vector3d corrected_m_ = Eigen::Vector3d::Zero();
};

}  // namespace flextip
