#include "recording/frames/frame_sets.h"

#include <algorithm>
#include <utility>

namespace flextip {

std::vector<const Image*> FrameSet::Pointers() const {
  std::vector<const Image*> pointers;
  for (const auto& image : images) pointers.push_back(image ? &*image : nullptr);
  return pointers;
}

std::vector<FramePair> PairFrames(const std::vector<TimeNs>& first,
                                  const std::vector<TimeNs>& second, TimeNs tolerance_ns) {
  std::vector<FramePair> pairs;
  std::size_t i = 0, j = 0;
  while (i < first.size() && j < second.size()) {
    const TimeNs apart = second[j] - first[i];
    const auto nearer = [&](const std::vector<TimeNs>& times, std::size_t next, TimeNs other) {
      return next < times.size() && std::abs(times[next] - other) < std::abs(apart);
    };
    const bool together = std::abs(apart) <= tolerance_ns && !nearer(first, i + 1, second[j]) &&
                          !nearer(second, j + 1, first[i]);
    if (together) {
      pairs.push_back({first[i++], true, true});
      ++j;
    } else if (apart >= 0) {
      pairs.push_back({first[i++], true, false});
    } else {
      pairs.push_back({second[j++], false, true});
    }
  }
  for (; i < first.size(); ++i) pairs.push_back({first[i], true, false});
  for (; j < second.size(); ++j) pairs.push_back({second[j], false, true});
  return pairs;
}

FrameSets::FrameSets(std::unique_ptr<FrameSource> only) { sources_.push_back(std::move(only)); }

FrameSets::FrameSets(std::unique_ptr<FrameSource> first, std::unique_ptr<FrameSource> second,
                     std::vector<FramePair> pairs)
    : pairs_(std::move(pairs)) {
  sources_.push_back(std::move(first));
  sources_.push_back(std::move(second));
}

std::size_t FrameSets::Count() const {
  return sources_.size() == 1 ? sources_[0]->Count() : pairs_.size();
}

void FrameSets::Skip(std::size_t sets) {
  if (sources_.size() == 1) return sources_[0]->Skip(sets);
  for (; sets > 0 && next_ < pairs_.size(); --sets, ++next_) {
    if (pairs_[next_].first) sources_[0]->Skip(1);
    if (pairs_[next_].second) sources_[1]->Skip(1);
  }
}

std::optional<FrameSet> FrameSets::Next() {
  FrameSet set;
  if (sources_.size() == 1) {
    auto frame = sources_[0]->Next();
    if (!frame) return {};
    set.t_ns = frame->t_ns;
    set.images.emplace_back(std::move(frame->image));
    return set;
  }
  while (next_ < pairs_.size()) {
    const FramePair& pair = pairs_[next_++];
    auto first = pair.first ? sources_[0]->Next() : std::nullopt;
    auto second = pair.second ? sources_[1]->Next() : std::nullopt;
    if (!first && !second) continue;
    set.t_ns = first ? first->t_ns : second->t_ns;
    set.images.resize(2);
    if (first) set.images[0] = std::move(first->image);
    if (second) set.images[1] = std::move(second->image);
    return set;
  }
  return {};
}

}  // namespace flextip
