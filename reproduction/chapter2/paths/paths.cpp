#include "reproduction/chapter2/paths/paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"

namespace flextip::reproduction {
namespace {

/// d wrist for a step of the tip, by the straight shaft through the estimated port.
Eigen::Vector2d WristStep(const TrajectoryMove& move, const Eigen::Vector2d& p_wrist,
                          const Eigen::Vector2d& tip_step) {
  PlanarInstrument believed = move.instrument;
  believed.p_port = move.p_port_estimated;
  return believed.TipByWrist(p_wrist).inverse() * tip_step;
}

Eigen::Vector2d Start(const TrajectoryMove& move) {
  const auto p_wrist = move.instrument.WristForTip(move.p_start);
  if (!p_wrist) throw WorkError("the arm cannot put the tip at the start of the move");
  return *p_wrist;
}

/// The arm under its controller, period by period. Angles here are the motors': the first joint's,
/// and the sum of both.
class ArmMove {
 public:
  ArmMove(const TrajectoryMove& move, const ArmRig& rig)
      : move_(move), rig_(rig), arm_(Longer(rig), Shaft(move, rig)) {
    const Eigen::Vector2d theta = move.instrument.arm.Solve(Start(move)).theta;
    state_.angles = {theta[0], theta.sum()};
    goal_angles_ = state_.angles;
    pid_.emplace(rig.pid, arm_.GravityTorque(state_.angles));
  }

  TrajectoryPath Run() {
    const double period_s = 1.0 / rig_.rate_hz;
    const int periods = static_cast<int>(rig_.longest_s * rig_.rate_hz);
    int close = 0;
    for (int period = 0; period < periods && close < 0.3 * rig_.rate_hz; ++period) {
      const std::optional<Eigen::Vector2d> p_tip = CalculatedTip();
      path_.left_port = !p_tip;
      if (path_.left_port) break;
      path_.p_tip.push_back(*p_tip);
      path_.t_s.push_back(period * period_s);
      close = (move_.p_goal - *p_tip).norm() < kGoalReached_m ? close + 1 : 0;
      Advance(*p_tip, period_s);
    }
    path_.reached = close > 0;
    return std::move(path_);
  }

 private:
  static simulation::ArmBody Longer(const ArmRig& rig) {
    simulation::ArmBody body = rig.body;
    body.link1_m *= 1.0 + rig.link_error;
    body.link2_m *= 1.0 + rig.link_error;
    return body;
  }
  static simulation::PortedShaft Shaft(const TrajectoryMove& move, const ArmRig& rig) {
    simulation::PortedShaft shaft;
    shaft.length_m = move.instrument.shaft_m;
    shaft.mass_kg = rig.shaft_mass_kg;
    shaft.p_port = move.instrument.p_port;
    shaft.friction_N = rig.friction_N;
    shaft.gravity_m_s2 = rig.gravity_m_s2;
    return shaft;
  }

  Eigen::Vector2d MeasuredAngles() const {
    if (rig_.encoder_rad <= 0.0) return state_.angles;
    return (state_.angles / rig_.encoder_rad).array().round() * rig_.encoder_rad;
  }
  /// The joint angles of kinematics/arm.h.
  Eigen::Vector2d Joints() const {
    const Eigen::Vector2d angles = MeasuredAngles();
    return {angles[0], angles[1] - angles[0]};
  }
  /// Empty once the shaft has slipped out of its port: the wrist has gone round it.
  std::optional<Eigen::Vector2d> CalculatedTip() const {
    const Eigen::Vector2d p_wrist = move_.instrument.arm.Wrist(Joints());
    constexpr double kNearest_m = 0.01;
    if ((move_.instrument.p_port - p_wrist).norm() < kNearest_m) return std::nullopt;
    return move_.instrument.Tip(p_wrist);
  }

  void Advance(const Eigen::Vector2d& p_tip, double period_s) {
    const PlanarArm& arm = move_.instrument.arm;
    const Eigen::Vector2d wrist_step =
        WristStep(move_, arm.Wrist(Joints()), rig_.gain * (move_.p_goal - p_tip));
    const Eigen::Vector2d joint_step = arm.Jacobian(Joints()).inverse() * wrist_step;
    const Eigen::Vector2d step(joint_step[0], joint_step.sum());
    const bool accumulated = rig_.joint_goal == JointGoal::kAccumulated;
    goal_angles_ = (accumulated ? goal_angles_ : MeasuredAngles()) + step;
    const Eigen::Vector2d torque =
        pid_->Torque(goal_angles_ - MeasuredAngles(), state_.rates, period_s);
    for (int i = 0; i < rig_.substeps; ++i) {
      arm_.Step(state_, torque, Eigen::Vector2d::Zero(), period_s / rig_.substeps);
    }
  }

  const TrajectoryMove& move_;
  const ArmRig& rig_;
  simulation::DynamicArm arm_;
  simulation::ArmState state_;
  std::optional<simulation::JointPid> pid_;
  Eigen::Vector2d goal_angles_;
  TrajectoryPath path_;
};

double DistanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

}  // namespace

TrajectoryPath QuasiStaticPath(const TrajectoryMove& move, double gain) {
  constexpr int kMostSteps = 20000;
  Eigen::Vector2d p_wrist = Start(move);
  TrajectoryPath path;
  path.p_tip.push_back(move.p_start);
  while (path.p_tip.size() < kMostSteps && !path.reached) {
    const Eigen::Vector2d left = move.p_goal - path.p_tip.back();
    p_wrist += WristStep(move, p_wrist, gain * left);
    const auto p_tip = move.instrument.Tip(p_wrist);
    if (!p_tip) return path;
    path.p_tip.push_back(*p_tip);
    path.reached = (move.p_goal - *p_tip).norm() < 0.1 * kGoalReached_m;
  }
  return path;
}

TrajectoryPath DynamicPath(const TrajectoryMove& move, const ArmRig& rig) {
  return ArmMove(move, rig).Run();
}

double LargestDistance(const TrajectoryPath& path, const TrajectoryPath& reference) {
  double largest = 0.0;
  for (const Eigen::Vector2d& p : path.p_tip) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < reference.p_tip.size(); ++i) {
      nearest = std::min(nearest, DistanceToSegment(p, reference.p_tip[i - 1], reference.p_tip[i]));
    }
    largest = std::max(largest, nearest);
  }
  return largest;
}

double LargestHeadingError(const TrajectoryPath& path, const Eigen::Vector2d& p_goal,
                           double near_m) {
  constexpr double kLeast_m = 1e-4;  // a motion's direction is that of its last 0.1 mm
  double largest = 0.0;
  Eigen::Vector2d from = path.p_tip.front();
  for (const Eigen::Vector2d& p : path.p_tip) {
    const Eigen::Vector2d moved = p - from, desired = p_goal - from;
    if (desired.norm() < near_m) break;
    if (moved.norm() < kLeast_m) continue;
    const double cosine = moved.dot(desired) / (moved.norm() * desired.norm());
    largest = std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)));
    from = p;
  }
  return largest;
}

double MovesAway(const TrajectoryPath& path, const Eigen::Vector2d& p_goal) {
  double nearest = std::numeric_limits<double>::infinity(), away = 0.0;
  for (const Eigen::Vector2d& p : path.p_tip) {
    const double distance = (p_goal - p).norm();
    nearest = std::min(nearest, distance);
    away = std::max(away, distance - nearest);
  }
  return away;
}

}  // namespace flextip::reproduction
