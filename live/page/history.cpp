#include "live/page/history.h"

#include <algorithm>
#include <utility>

#include "vision/tracking/tip_prediction.h"

namespace flextip::live {
namespace {

constexpr TimeNs kKept_ns = 60'000'000'000;
constexpr std::size_t kMostRows = 2400, kMostPlaces = 2000, kMostEvents = 60;

}  // namespace

void PageHistory::Add(const PageSnapshot& snapshot) {
  Row row;
  row.t_ns = snapshot.record.inputs.t_ns;
  if (!rows_.empty() && row.t_ns <= rows_.back().t_ns) return;
  if (snapshot.on_path) row.deviation_m = snapshot.deviation_m;
  const ShaftEstimate& estimate = snapshot.command.estimate;
  if (snapshot.command.status != ControlStatus::kNoWrist && estimate.measurements > 0)
    row.sd_m = MaxSd(estimate.p_RE_covariance_m2);
  rows_.push_back(row);
  while (rows_.size() > kMostRows || rows_.front().t_ns < row.t_ns - kKept_ns) rows_.pop_front();
  if (!snapshot.on_path) return;
  const Eigen::Vector3d& p = snapshot.record.outputs.p_RE;
  if (!way_.empty() && (p - way_.back()).norm() < apart_m_) return;
  way_.push_back(p);
  if (way_.size() < kMostPlaces) return;
  for (std::size_t i = 0; 2 * i < way_.size(); ++i) way_[i] = way_[2 * i];
  way_.resize(way_.size() / 2);
  apart_m_ *= 2.0;
}

void PageHistory::AddEvent(PageEvent event) {
  event.n = ++events_count_;
  events_.push_back(std::move(event));
  if (events_.size() > kMostEvents) events_.pop_front();
}

std::vector<PageEvent> PageHistory::Events(std::size_t most) const {
  const auto count = static_cast<std::ptrdiff_t>(std::min(most, events_.size()));
  return {events_.end() - count, events_.end()};
}

}  // namespace flextip::live
