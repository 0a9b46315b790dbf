#include "workspace/tolerance.h"

#include <tbb/parallel_for.h>

#include <utility>
#include <vector>

namespace flextip {
namespace {

/// Points on the part's border are in it, however they are rounded.
template <int N>
bool InPart(const ToleranceQuestion<N>& question, const VectorN<N>& p) {
  constexpr double kRounding_m = 1e-9;
  return (p.array() >= question.part_min.array() - kRounding_m).all() &&
         (p.array() <= question.part_max.array() + kRounding_m).all();
}

/// One question at one map.
template <int N>
class ToleranceSearch {
 public:
  ToleranceSearch(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                  const ToleranceQuestion<N>& question)
      : setup_(setup), map_(map), question_(question) {}

  Tolerance<N> Find() {
    for (std::size_t i = 0; i < map_.points.size(); ++i)
      if (map_.points[i].state && InPart(question_, map_.points[i].p_tip)) candidates_.push_back(i);
    answer_.points = candidates_.size();
    if (candidates_.empty()) return answer_;
    if (Passes(0.0)) return Ended(ToleranceStatus::kFailsAlready);
    constexpr double kMost = 1000.0, kRelative = 1e-4;
    double low = 0.0, high = 1.0;
    while (!Passes(high)) {
      low = high;
      high *= 2.0;
      if (low >= kMost) {
        answer_.scale = low;
        return Ended(ToleranceStatus::kNoLimit);
      }
    }
    while (high - low > kRelative * high && high > 1e-9) {
      const double middle = 0.5 * (low + high);
      (Passes(middle) ? high : low) = middle;
    }
    answer_.scale = low;
    return Ended(ToleranceStatus::kOk);
  }

 private:
  /// Whether the limit is reached anywhere at this scale. Then only where it is can it be reached
  /// at a smaller one.
  bool Passes(double scale);

  Tolerance<N> Ended(ToleranceStatus status) {
    answer_.status = status;
    return answer_;
  }

  const MapSetup<N>& setup_;
  const WorkspaceMap<N>& map_;
  const ToleranceQuestion<N>& question_;
  std::vector<std::size_t> candidates_;
  Tolerance<N> answer_;
};

}  // namespace

const char* Name(ToleranceStatus status) {
  switch (status) {
    case ToleranceStatus::kOk:
      return "ok";
    case ToleranceStatus::kFailsAlready:
      return "fails already";
    case ToleranceStatus::kNoLimit:
      return "no limit found";
    case ToleranceStatus::kEmptyPart:
      return "no reachable point in the part";
  }
  return "?";
}

template <int N>
bool ToleranceSearch<N>::Passes(double scale) {
  std::vector<WorstError<N>> worst(candidates_.size());
  tbb::parallel_for(std::size_t{0}, candidates_.size(), [&](std::size_t i) {
    const TrueState<N>& state = *map_.points[candidates_[i]].state;
    worst[i] = FindWorst(setup_, state, question_.bounds, question_.measure, scale);
  });
  std::vector<std::size_t> passing;
  double largest = -1.0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (worst[i].value < question_.limit) continue;
    passing.push_back(candidates_[i]);
    if (worst[i].value <= largest) continue;
    largest = worst[i].value;
    answer_.point = candidates_[i];
    answer_.first = worst[i];
  }
  if (passing.empty()) return false;
  candidates_ = std::move(passing);
  return true;
}

template <int N>
Tolerance<N> FindTolerance(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                           const ToleranceQuestion<N>& question) {
  return ToleranceSearch<N>(setup, map, question).Find();
}

template Tolerance<2> FindTolerance(const MapSetup<2>&, const WorkspaceMap<2>&,
                                    const ToleranceQuestion<2>&);
template Tolerance<3> FindTolerance(const MapSetup<3>&, const WorkspaceMap<3>&,
                                    const ToleranceQuestion<3>&);

}  // namespace flextip
