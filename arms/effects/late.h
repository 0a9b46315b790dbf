// A signal late by a time, or through a first-order lag.
#pragma once

#include <Eigen/Dense>

#include "arms/data/arm_data.h"

namespace flextip::arms {

/// Slopes at the samples: means of those beside.
Eigen::VectorXd Slopes(const Eigen::VectorXd& t_s, const Eigen::VectorXd& x);

/// x(t - delay), x smooth between its samples (Hermite's cubics) and at rest beyond its ends.
Eigen::VectorXd Delayed(const Eigen::VectorXd& t_s, const Eigen::VectorXd& x, double delay_s);

/// T y' + y = x, exact for an x that is linear between its samples; y moves as x does at the start.
/// A negative time counts by its first-order effect, -T x'.
Eigen::VectorXd Lagged(const Eigen::VectorXd& t_s, const Eigen::VectorXd& x, double time_s);

/// Whether what happens between command and joint could show: commands of a moving arm, and
/// encoders or something else that tells where it went.
inline bool ActsOnMotion(const ArmData& data) {
  return data.has_command && !data.at_stops &&
         (data.followed.Any() || (!data.has_encoders && (data.seen.Any() || data.pose.Any())));
}

}  // namespace flextip::arms
