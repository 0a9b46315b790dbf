#include "control/tip_path.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra/segment.h"
#include "core/rotation.h"

namespace flextip {

TipPath::TipPath(const PathSetup& setup, const Pose& T_RE, double update_rate_hz)
    : setup_(setup), update_rate_hz_(update_rate_hz), points_{T_RE.p}, d_start_(T_RE.R.col(0)) {
  const bool from_start = setup.frame == PathFrame::kStart;
  for (const auto& waypoint : setup.waypoints_m)
    points_.emplace_back(from_start ? Eigen::Vector3d(T_RE.p + waypoint) : waypoint);
}

std::optional<Eigen::Vector3d> TipPath::Direction() const {
  if (setup_.directions.empty()) return {};
  const Eigen::Vector3d& from = leg_ > 0 ? setup_.directions[leg_ - 1] : d_start_;
  const Eigen::Vector3d& to = setup_.directions[leg_];
  const double length = LegLength(leg_);
  const double part = length > 0 ? std::min(1.0, travelled_m_ / length) : 1.0;
  const Eigen::Matrix3d turn = ExpRotation(part * LogRotation(RotationWithoutTwist(from, to)));
  return turn * from;
}

Eigen::Vector3d TipPath::Along(std::size_t leg, double travelled_m) const {
  const double length = LegLength(leg);
  if (travelled_m >= length) return points_[leg + 1];
  return points_[leg] + travelled_m / length * (points_[leg + 1] - points_[leg]);
}

void TipPath::VisitState(StateText& state) {
  state(leg_);
  state(travelled_m_);
  state(updates_);
  state(done_);
  if (leg_ + 1 >= points_.size()) throw InputError("saved state: a leg that the path has not");
}

Eigen::Vector3d TipPath::Advance(const Eigen::Vector3d& p_RE_known) {
  return setup_.mode == PathMode::kContinuous ? AdvanceContinuous() : AdvanceStep(p_RE_known);
}

Eigen::Vector3d TipPath::AdvanceContinuous() {
  travelled_m_ += setup_.speed_m_s / update_rate_hz_;
  while (leg_ + 2 < points_.size() && travelled_m_ >= LegLength(leg_)) {
    travelled_m_ -= LegLength(leg_);
    ++leg_;
  }
  if (travelled_m_ >= LegLength(leg_)) {
    done_ = ++updates_ >= setup_.settle_s * update_rate_hz_;
  }
  return Along(leg_, travelled_m_);
}

Eigen::Vector3d TipPath::AdvanceStep(const Eigen::Vector3d& p_RE_known) {
  const bool at_end = travelled_m_ >= LegLength(leg_);
  const bool reached = at_end && (p_RE_known - points_[leg_ + 1]).norm() < setup_.reached_m;
  if (reached || updates_ >= setup_.max_updates) {
    updates_ = 0;
    if (leg_ + 2 == points_.size()) {
      done_ = true;
      return points_.back();
    }
    travelled_m_ = 0.0;
    ++leg_;
  }
  travelled_m_ += setup_.step_m;
  ++updates_;
  return Along(leg_, travelled_m_);
}

double TipPath::Deviation(const Eigen::Vector3d& p) const {
  const auto distance_from_leg = [&](std::size_t leg) {
    return (p - NearestOnSegment(points_[leg], points_[leg + 1], p)).norm();
  };
  const double distance = distance_from_leg(leg_);
  return leg_ > 0 ? std::min(distance, distance_from_leg(leg_ - 1)) : distance;
}

int TipPath::MaxUpdates() const {
  const int legs = static_cast<int>(points_.size()) - 1;
  if (setup_.mode == PathMode::kSteps) return legs * (setup_.max_updates + 1) + 1;
  double length = 0.0;
  for (int leg = 0; leg < legs; ++leg) length += LegLength(static_cast<std::size_t>(leg));
  const double seconds = length / setup_.speed_m_s + setup_.settle_s;
  return static_cast<int>(std::ceil(seconds * update_rate_hz_)) + 2;
}

}  // namespace flextip
