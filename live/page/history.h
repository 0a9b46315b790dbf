// The last minute and the way so far, for watchers that come later. Bounded.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "core/time_series.h"
#include "live/page/snapshot.h"

namespace flextip::live {

class PageHistory {
 public:
  struct Row {
    TimeNs t_ns = 0;
    std::optional<double> deviation_m, sd_m;  ///< of the tip from the path; in its worst direction
  };

  void Add(const PageSnapshot& snapshot);
  /// Adds an event, which gets the next number.
  void AddEvent(PageEvent event);

  /// Returns the rows of the last minute, by time.
  const std::deque<Row>& Rows() const { return rows_; }
  /// Returns places of the tip on its path so far (m, in R).
  const std::vector<Eigen::Vector3d>& Way() const { return way_; }
  /// Returns the last events, the newest at the end.
  std::vector<PageEvent> Events(std::size_t most) const;

 private:
  std::deque<Row> rows_;
  std::vector<Eigen::Vector3d> way_;
  double apart_m_ = 1e-4;  // of the way's places; twice as much whenever there are too many
  long events_count_ = 0;
  std::deque<PageEvent> events_;
};

}  // namespace flextip::live
