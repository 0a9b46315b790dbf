#include "workspace/motion_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace flextip {
namespace {

/// A at a place of the slice, between the four points around it.
template <int N>
std::optional<MatrixN<N>> Between(const WorkspaceMap<N>& map, const Eigen::Vector2d& p) {
  const double c = (p.x() - map.right_m.front()) / map.spacing_m;
  const double r = (p.y() - map.up_m.front()) / map.spacing_m;
  if (!(c >= 0.0 && r >= 0.0)) return std::nullopt;
  const auto column = std::size_t(c), row = std::size_t(r);
  if (column >= map.right_m.size() || row >= map.up_m.size()) return std::nullopt;
  const double x = c - double(column), y = r - double(row);
  MatrixN<N> sum = MatrixN<N>::Zero();
  for (const std::size_t up : {0U, 1U}) {
    for (const std::size_t right : {0U, 1U}) {
      const double weight = (right ? x : 1.0 - x) * (up ? y : 1.0 - y);
      if (weight < 1e-9) continue;
      if (row + up >= map.up_m.size() || column + right >= map.right_m.size()) return std::nullopt;
      const auto& A = map.At(row + up, column + right).A;
      if (!A) return std::nullopt;
      sum += weight * *A;
    }
  }
  return sum;
}

template <int N>
VectorN<N> Nearest(const VectorN<N>& p, const VectorN<N>& a, const VectorN<N>& b) {
  const VectorN<N> along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 == 0.0) return a;
  return a + std::clamp((p - a).dot(along) / length2, 0.0, 1.0) * along;
}

template <int N>
double DistanceFrom(const std::vector<VectorN<N>>& path, const VectorN<N>& p) {
  double least = (path.front() - p).norm();
  for (std::size_t i = 1; i < path.size(); ++i)
    least = std::min(least, (Nearest<N>(p, path[i - 1], path[i]) - p).norm());
  return least;
}

/// Places `move_m` apart along the path, ending with its end.
template <int N>
std::vector<VectorN<N>> Goals(const std::vector<VectorN<N>>& path, double move_m) {
  std::vector<VectorN<N>> goals;
  double next = move_m, done = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const VectorN<N> piece = path[i] - path[i - 1];
    const double length = piece.norm();
    for (; next < done + length; next += move_m)
      goals.push_back(path[i - 1] + (next - done) / length * piece);
    done += length;
  }
  goals.push_back(path.back());
  return goals;
}

/// One cycle; empty where it ends outside the workspace.
template <int N>
std::optional<TrueState<N>> Step(const MapSetup<N>& setup, TrueShaft<N>& shaft,
                                 const TrueState<N>& state, const VectorN<N>& goal, double gain) {
  const auto belief = Believe(setup.truth, setup.error, state.theta);
  if (!belief) return std::nullopt;
  const VectorN<N> step = gain * belief->J_hat.inverse() * (goal - state.p_tip);
  const VectorN<N> theta = state.theta + step;
  if (!step.allFinite() || !setup.truth.arm.WithinLimits(theta)) return std::nullopt;
  return shaft.AtJoints(theta);
}

}  // namespace

const char* Name(FollowStatus status) {
  switch (status) {
    case FollowStatus::kOk:
      return "ok";
    case FollowStatus::kStartOutside:
      return "start outside the workspace";
    case FollowStatus::kLost:
      return "left the workspace";
    case FollowStatus::kNotArrived:
      return "a move did not arrive";
  }
  return "?";
}

template <int N>
PathCost MotionCost(const WorkspaceMap<N>& map, const PlanOptions& options) {
  return [&map, options](const Eigen::Vector2d& p, const Eigen::Vector2d& v) {
    const auto A = Between(map, p);
    if (!A) return std::numeric_limits<double>::infinity();
    VectorN<N> in_space = VectorN<N>::Zero();
    in_space[map.slice.right] = v.x();
    in_space[map.slice.up] = v.y();
    return 1.0 + options.weight * DirectionError<N>(*A, in_space, options.fault);
  };
}

template <int N>
Path PlanMotion(const WorkspaceMap<N>& map, const Eigen::Vector2d& start,
                const Eigen::Vector2d& goal, const PlanOptions& options) {
  return PlanPath(MotionCost(map, options), {.start = start,
                                             .goal = goal,
                                             .low = {map.right_m.front(), map.up_m.front()},
                                             .high = {map.right_m.back(), map.up_m.back()},
                                             .spacing_m = options.spacing_m});
}

template <int N>
Followed<N> FollowPath(const MapSetup<N>& setup, const std::vector<VectorN<N>>& path,
                       const FollowOptions& options) {
  FLEXTIP_CHECK(!path.empty(), "a path has a place");
  Followed<N> followed;
  TrueShaft<N> shaft(setup.truth, setup.force);
  const auto start = shaft.AtTip(path.front());
  if (!start) return followed;
  TrueState<N> now = *start;
  double gone = 0.0, sum = 0.0;
  for (const VectorN<N>& goal : Goals<N>(path, options.move_m)) {
    int cycles = 0;
    for (; (goal - now.p_tip).norm() >= options.arrived_m; ++cycles) {
      followed.status = FollowStatus::kNotArrived;
      if (cycles == options.cycles_per_move) return followed;
      const auto next = Step(setup, shaft, now, goal, options.gain);
      followed.status = FollowStatus::kLost;
      if (!next) return followed;
      const double deviation = DistanceFrom(path, next->p_tip);
      followed.max_deviation_m = std::max(followed.max_deviation_m, deviation);
      gone += (next->p_tip - now.p_tip).norm();
      sum += deviation * (next->p_tip - now.p_tip).norm();
      followed.mean_deviation_m = sum / gone;
      followed.tips.push_back(next->p_tip);
      now = *next;
    }
  }
  followed.status = FollowStatus::kOk;
  return followed;
}

template PathCost MotionCost(const WorkspaceMap<2>&, const PlanOptions&);
template PathCost MotionCost(const WorkspaceMap<3>&, const PlanOptions&);
template Path PlanMotion(const WorkspaceMap<2>&, const Eigen::Vector2d&, const Eigen::Vector2d&,
                         const PlanOptions&);
template Path PlanMotion(const WorkspaceMap<3>&, const Eigen::Vector2d&, const Eigen::Vector2d&,
                         const PlanOptions&);
template Followed<2> FollowPath(const MapSetup<2>&, const std::vector<VectorN<2>>&,
                                const FollowOptions&);
template Followed<3> FollowPath(const MapSetup<3>&, const std::vector<VectorN<3>>&,
                                const FollowOptions&);

}  // namespace flextip
