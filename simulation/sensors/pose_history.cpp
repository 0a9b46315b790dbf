#include "simulation/sensors/pose_history.h"

#include <algorithm>

#include "core/check.h"
#include "core/rotation.h"

namespace flextip::simulation {
namespace {

constexpr TimeNs kKept_ns = 1'000'000'000;

}  // namespace

void PoseHistory::Add(TimeNs t_ns, const Pose& pose) {
  if (!entries_.empty() && entries_.back().t_ns == t_ns) entries_.pop_back();
  FLEXTIP_CHECK(entries_.empty() || entries_.back().t_ns < t_ns, "strictly increasing time");
  entries_.push_back({t_ns, pose});
  while (entries_.front().t_ns < t_ns - kKept_ns) entries_.pop_front();
}

Pose PoseHistory::At(TimeNs t_ns) const {
  FLEXTIP_CHECK(!entries_.empty(), "the history has a pose");
  if (t_ns <= entries_.front().t_ns) return entries_.front().value;
  if (t_ns >= entries_.back().t_ns) return entries_.back().value;
  const auto after =
      std::upper_bound(entries_.begin(), entries_.end(), t_ns,
                       [](TimeNs t, const Sample<Pose>& entry) { return t < entry.t_ns; });
  const int size = static_cast<int>(entries_.size());
  const int before = static_cast<int>(after - entries_.begin()) - 1;
  const int count = std::min(4, size), first = std::clamp(before - 1, 0, size - count);
  const Pose& reference = entries_[before].value;
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  for (int i = first; i < first + count; ++i) {
    double weight = 1.0;  // Lagrange's
    for (int j = first; j < first + count; ++j) {
      if (j == i) continue;
      weight *= static_cast<double>(t_ns - entries_[j].t_ns) /
                static_cast<double>(entries_[i].t_ns - entries_[j].t_ns);
    }
    p += weight * entries_[i].value.p;
    if (i != before) turn += weight * LogRotation(entries_[i].value.R * reference.R.transpose());
  }
  return {ExpRotation(turn) * reference.R, p};
}

}  // namespace flextip::simulation
