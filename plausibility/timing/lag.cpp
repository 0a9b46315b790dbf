#include "plausibility/timing/lag.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

constexpr TimeNs kCoarse_ns = 100'000'000, kFine_ns = 20'000'000;
constexpr std::int64_t kWishedTimes = 60;  // in short recordings
constexpr std::int64_t kMostTimes = 300;
constexpr std::size_t kFewest = 30;
constexpr double kLeastShare = 0.4, kLongest_s = 600.0;

TimeNs ToNs(double seconds) { return static_cast<TimeNs>(std::llround(seconds * 1e9)); }

/// Sums for a correlation of two series of vectors, each about its mean.
class Correlation {
 public:
  void Add(const Vector3d& a, const Vector3d& b) {
    ++count_;
    sum_a_ += a, sum_b_ += b;
    aa_ += a.squaredNorm(), bb_ += b.squaredNorm(), ab_ += a.dot(b);
  }
  std::size_t Count() const { return count_; }
  double Value() const {
    const double n = static_cast<double>(count_);
    const double aa = aa_ - sum_a_.squaredNorm() / n, bb = bb_ - sum_b_.squaredNorm() / n;
    return aa > 0.0 && bb > 0.0 ? (ab_ - sum_a_.dot(sum_b_) / n) / std::sqrt(aa * bb) : 0.0;
  }

 private:
  std::size_t count_ = 0;
  Vector3d sum_a_ = Vector3d::Zero(), sum_b_ = Vector3d::Zero();
  double aa_ = 0.0, bb_ = 0.0, ab_ = 0.0;
};

/// The first quantity at some times of the grid, the second at all it is asked for.
class LagFinder {
 public:
  LagFinder(const VectorAt& a, const VectorAt& b, const LagSearch& search)
      : b_(b),
        begin_ns_(search.begin_ns),
        grid_ns_(std::clamp((search.end_ns - begin_ns_) / kWishedTimes, kFine_ns, kCoarse_ns)) {
    const TimeNs end_ns = std::min(search.end_ns, begin_ns_ + ToNs(kLongest_s));
    const std::int64_t all = (end_ns - begin_ns_) / grid_ns_;
    const std::int64_t stride = std::max<std::int64_t>(1, all / kMostTimes);
    for (std::int64_t i = 0; i <= all; i += stride) {
      if (const auto value = a(begin_ns_ + i * grid_ns_)) known_.emplace_back(i, *value);
    }
    // The grid of the second quantity, as far as it is asked for.
    first_ = StepsOf(search.around_s - search.reach_s);
    const std::int64_t last = all + StepsOf(search.around_s + search.reach_s);
    if (known_.size() < kFewest) return;
    for (std::int64_t i = first_; i <= last; ++i) on_grid_.push_back(b(begin_ns_ + i * grid_ns_));
  }

  bool IsEnough() const { return known_.size() >= kFewest; }
  TimeNs Grid_ns() const { return grid_ns_; }
  std::int64_t StepsOf(double seconds) const {
    return std::llround(seconds * 1e9 / static_cast<double>(grid_ns_));
  }

  /// Returns the correlation at a shift by whole steps of the grid.
  std::optional<double> AtSteps(std::int64_t shift) const {
    Correlation sums;
    for (const auto& [i, value] : known_) {
      const std::int64_t at = i + shift - first_;
      if (at < 0 || at >= static_cast<std::int64_t>(on_grid_.size())) continue;
      if (const auto& other = on_grid_[static_cast<std::size_t>(at)]) sums.Add(value, *other);
    }
    return Judge(sums);
  }

  std::optional<double> At(TimeNs shift_ns) const {
    Correlation sums;
    for (const auto& [i, value] : known_) {
      if (const auto other = b_(begin_ns_ + i * grid_ns_ + shift_ns)) sums.Add(value, *other);
    }
    return Judge(sums);
  }

 private:
  std::optional<double> Judge(const Correlation& sums) const {
    const double share = static_cast<double>(sums.Count()) / static_cast<double>(known_.size());
    if (sums.Count() < kFewest || share < kLeastShare) return {};
    return sums.Value();
  }

  const VectorAt& b_;
  TimeNs begin_ns_, grid_ns_;
  std::int64_t first_ = 0;
  std::vector<std::pair<std::int64_t, Vector3d>> known_;  // steps of the grid, values
  std::vector<std::optional<Vector3d>> on_grid_;
};

void Refine(const LagFinder& finder, Lag& lag) {
  const TimeNs coarse_ns = ToNs(lag.seconds), grid_ns = finder.Grid_ns();
  for (TimeNs shift = coarse_ns - grid_ns; shift <= coarse_ns + grid_ns; shift += kFine_ns) {
    const auto c = finder.At(shift);
    if (c && *c > lag.correlation)
      lag.seconds = 1e-9 * static_cast<double>(shift), lag.correlation = *c;
  }
}

}  // namespace

bool Lag::IsClear() const {
  constexpr double kAlike = 0.85, kPart = 0.4;
  return correlation >= kAlike && 1.0 - correlation <= kPart * (1.0 - correlation_at_zero);
}

std::vector<Lag> FindLags(const VectorAt& a, const VectorAt& b, const LagSearch& search) {
  constexpr std::size_t kMost = 12;
  constexpr double kLeast = 0.5, kNone = -2.0;
  const LagFinder finder(a, b, search);
  if (!finder.IsEnough()) return {};
  const std::int64_t first = finder.StepsOf(search.around_s - search.reach_s);
  const std::int64_t last = finder.StepsOf(search.around_s + search.reach_s);
  std::vector<double> at_steps;
  for (std::int64_t shift = first; shift <= last; ++shift)
    at_steps.push_back(finder.AtSteps(shift).value_or(kNone));
  std::vector<Lag> lags;
  for (std::size_t i = 1; i + 1 < at_steps.size(); ++i) {
    const double before = at_steps[i - 1], after = at_steps[i + 1];
    if (at_steps[i] < kLeast || before == kNone || after == kNone) continue;
    if (before > at_steps[i] || after >= at_steps[i]) continue;
    const TimeNs at_ns = (first + static_cast<std::int64_t>(i)) * finder.Grid_ns();
    lags.push_back({1e-9 * static_cast<double>(at_ns), at_steps[i], 0.0});
  }
  const auto better = [](const Lag& x, const Lag& y) { return x.correlation > y.correlation; };
  std::stable_sort(lags.begin(), lags.end(), better);
  if (lags.size() > kMost) lags.resize(kMost);
  const double at_zero = finder.At(0).value_or(0.0);
  for (Lag& lag : lags) {
    lag.correlation_at_zero = at_zero;
    Refine(finder, lag);
  }
  std::stable_sort(lags.begin(), lags.end(), better);
  return lags;
}

}  // namespace flextip::plausibility
