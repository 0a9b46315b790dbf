// The last minute and the way so far, for watchers that come later. Bounded.
#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "core/time_series.h"
#include "live/page/snapshot.h"

namespace flextip::live {

class PageHistory {
 public:
  void Add(const PageSnapshot& snapshot);
  /// Adds an event, which gets the next number.
  void AddEvent(nlohmann::ordered_json event);

  /// Returns {times, deviations, sds, way}: rows of the last minute, and places of the tip.
  nlohmann::ordered_json Json() const;
  /// Returns the last events, the newest at the end, with their numbers.
  nlohmann::ordered_json Events(std::size_t most) const;

 private:
  struct Row {
    TimeNs t_ns = 0;
    std::optional<double> deviation_m, sd_m;
  };
  std::deque<Row> rows_;
  std::vector<Eigen::Vector3d> way_;
  double apart_m_ = 1e-4;  // of the way's places; twice as much whenever there are too many
  long events_count_ = 0;
  std::deque<nlohmann::ordered_json> events_;
};

}  // namespace flextip::live
