#include "control/supervision/commanded_way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/linear_algebra/segment.h"

namespace flextip {
namespace {

// Of three components at once, each normal, less than one in 1e7 is this many deviations long.
constexpr double kDeviations = 6.0;
constexpr double kSettle_m = 0.0005;  // a servo may stay so far from its set-point

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// How far two readings of one place may differ.
double Noise_m(const WristReading& wrist) {
  return kDeviations * std::numbers::sqrt2 * wrist.noise_m;
}

}  // namespace

double CommandedWay::AllowedBeside_m(const WristReading& wrist) {
  return kSettle_m + Noise_m(wrist);
}

void CommandedWay::Keep(const WristReading& wrist, const Eigen::Vector3d& p_RW_command) {
  sent_[next_] = {wrist.t_ns, p_RW_command, wrist.p_RW.value_or(p_RW_command)};
  next_ = (next_ + 1) % kSize;
  count_ = std::min(count_ + 1, kSize);
}

void CommandedWay::Replace(const Eigen::Vector3d& p_RW_command) {
  sent_[(next_ + kSize - 1) % kSize].p_RW = p_RW_command;
}

void CommandedWay::VisitState(StateText& state) {
  state(next_);
  state(count_);
  if (next_ >= kSize || count_ > kSize) throw InputError("saved state: no place in a ring");
  for (std::size_t i = 1; i <= count_; ++i) state(sent_[(next_ + kSize - i) % kSize]);
}

double CommandedWay::Beside_m(const WristReading& wrist) const {
  if (!wrist.p_RW || count_ == 0) return 0.0;
  double nearest_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d later = Ago(1).p_RW;
  for (std::size_t i = 1; i <= count_; ++i) {
    const Eigen::Vector3d on_way = NearestOnSegment(Ago(i).p_RW, later, *wrist.p_RW);
    nearest_m = std::min(nearest_m, (*wrist.p_RW - on_way).norm());
    later = Ago(i).p_RW;
    // The command of before the lag counts: the robot may only now leave it.
    if (Seconds(wrist.t_ns - Ago(i).t_ns) > follow_lag_s_) return nearest_m;
  }
  // Not commanded for long enough yet to say.
  return 0.0;
}

Eigen::Vector3d CommandedWay::NearestTo(const WristReading& wrist,
                                        const Eigen::Vector3d& p_last) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d nearest = p_last, later = p_last;
  for (std::size_t i = 1; i <= count_; ++i) {
    const Eigen::Vector3d on_way = NearestOnSegment(Ago(i).p_RW, later, *wrist.p_RW);
    const double distance_m = (*wrist.p_RW - on_way).norm();
    if (distance_m < nearest_m) nearest = on_way;
    nearest_m = std::min(nearest_m, distance_m);
    later = Ago(i).p_RW;
    if (Seconds(wrist.t_ns - Ago(i).t_ns) > follow_lag_s_) break;
  }
  return nearest;
}

bool CommandedWay::IsLeft(const WristReading& wrist) const {
  if (!wrist.p_RW || count_ == 0) return false;
  const double allowed_m = AllowedBeside_m(wrist);
  const Eigen::Vector3d& p_before = Ago(1).p_RW_before;
  const double moved_m = (*wrist.p_RW - p_before).norm();
  double farthest_m = 0.0, away_m = 0.0;
  for (std::size_t i = 1; i <= count_; ++i) {
    farthest_m = std::max(farthest_m, (Ago(i).p_RW - p_before).norm());
    away_m = std::max(away_m, (Ago(i).p_RW_before - *wrist.p_RW).norm());
    if (Seconds(wrist.t_ns - Ago(i).t_ns) <= follow_lag_s_) continue;
    const bool stands = away_m < allowed_m && Beside_m(wrist) > allowed_m;
    return stands || moved_m > farthest_m + allowed_m;
  }
  // Not commanded for long enough yet to say.
  return false;
}

bool CommandedWay::Lags(const WristReading& wrist) const {
  if (!wrist.p_RW || count_ == 0) return false;
  return (*wrist.p_RW - Ago(1).p_RW).norm() > AllowedBeside_m(wrist) &&
         (*wrist.p_RW - Ago(1).p_RW_before).norm() <= Noise_m(wrist);
}

}  // namespace flextip
