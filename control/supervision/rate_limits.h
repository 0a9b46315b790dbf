// Rate limits of the commanded wrist, and where the tip's goal may be: pure functions, each of
// which says whether it limited. In R.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// A box in R (m).
struct WorkspaceBox {
  Eigen::Vector3d lower_m = Eigen::Vector3d::Zero(), upper_m = Eigen::Vector3d::Zero();
};

/// A place and whether a limit moved it.
struct Limited {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m
  bool limited = false;
};

/// Returns `p_wish`, drawn to `p_RW`, the measured wrist, until it is `max_step_m` away at most.
Limited LimitStep(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_wish, double max_step_m);

/// Returns `p_wish`, drawn to `p_last`, the last command, so that the command moves with
/// `max_speed_m_s` at most in the `dt_s` between them.
Limited LimitSpeed(const Eigen::Vector3d& p_last, const Eigen::Vector3d& p_wish, double dt_s,
                   double max_speed_m_s);

/// Returns the place nearest to `p_wish` whose velocity from `p_last` differs from `v_last_m_s` by
/// `max_acceleration_m_s2` times `dt_s` at most. The velocity toward `p_wish` is held so low that
/// the command can stop there: sqrt(2 a d) at a distance d.
Limited LimitAcceleration(const Eigen::Vector3d& p_last, const Eigen::Vector3d& v_last_m_s,
                          const Eigen::Vector3d& p_wish, double dt_s, double max_acceleration_m_s2);

/// Returns the place in `box` nearest to `p`.
Limited KeepInBox(const WorkspaceBox& box, const Eigen::Vector3d& p);

}  // namespace flextip
