// The path the tip is asked to follow: straight legs between waypoints.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "core/state_text.h"

namespace flextip {

enum class PathMode {
  kContinuous,  ///< the goal moves along the legs at a speed
  kSteps,       ///< thesis 4.3.1: the goal moves on by a step each update and waits at a leg's end
};

enum class PathFrame : std::uint8_t {
  kStart,  ///< waypoints count from the tip at the start
  kRobot,  ///< waypoints are places in R
};

struct PathSetup {
  PathMode mode = PathMode::kContinuous;
  PathFrame frame = PathFrame::kStart;
  std::vector<Eigen::Vector3d> waypoints_m;  ///< in R
  std::vector<Eigen::Vector3d> directions;   ///< of the tip there, in R, unit; empty: any
  double speed_m_s = 0.02;                   ///< kContinuous
  double settle_s = 0.5;                     ///< kContinuous: held at the last waypoint
  double step_m = 0.002;                     ///< kSteps
  double reached_m = 0.00005;                ///< kSteps: close enough to a leg's end
  int max_updates = 40;                      ///< kSteps: for one leg
};

/// Where the tip should be, update by update.
class TipPath {
 public:
  /// Takes the tip at the start, `T_RE`.
  TipPath(const PathSetup& setup, const Pose& T_RE, double update_rate_hz);

  /// Returns the goal of the next update (m, in R). `p_RE_known` is the tip as the controller knows
  /// it.
  Eigen::Vector3d Advance(const Eigen::Vector3d& p_RE_known);
  /// Returns the tip's wished direction with the last goal: it turns evenly along a leg. Empty:
  /// any.
  std::optional<Eigen::Vector3d> Direction() const;
  bool Done() const { return done_; }
  /// Returns where the first leg starts (m, in R).
  const Eigen::Vector3d& Start() const { return points_.front(); }

  /// Returns the distance (m) of `p` from the path travelled so far: from the current leg and the
  /// last.
  double Deviation(const Eigen::Vector3d& p) const;
  /// Returns the largest number of updates that the path takes.
  int MaxUpdates() const;

  /// Visits the place on the path. The path itself must be the same one.
  void VisitState(StateText& state);

 private:
  Eigen::Vector3d AdvanceContinuous();
  Eigen::Vector3d AdvanceStep(const Eigen::Vector3d& p_RE_known);
  double LegLength(std::size_t leg) const { return (points_[leg + 1] - points_[leg]).norm(); }
  Eigen::Vector3d Along(std::size_t leg, double travelled_m) const;

  PathSetup setup_;
  double update_rate_hz_;
  std::vector<Eigen::Vector3d> points_;  // the start and the waypoints, in R
  Eigen::Vector3d d_start_;              // of the tip, in R
  std::size_t leg_ = 0;
  double travelled_m_ = 0.0;  // on the leg
  int updates_ = 0;           // on the leg, or of settling
  bool done_ = false;
};

}  // namespace flextip
