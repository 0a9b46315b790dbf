// What the page's thread finds out of the cycles that it sees: shaft, worst angle, rates. Private
// to live/page/.
#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <optional>
#include <vector>

#include "control/supervision/worst_motion.h"
#include "live/page/snapshot.h"
#include "pipeline/estimated_shape.h"

namespace flextip::live {

inline constexpr double kPageDeviations = 1.0;  ///< of the estimate, for the worst angle

/// The shaft and the goal of a cycle. In R.
struct ShaftMoment {
  TimeNs t_ns = 0;
  std::vector<ShapePoint> shape;  ///< empty: the estimate has none
  std::optional<Eigen::Vector3d> p_RE_goal;
};

struct PageFindings {
  ShaftMoment now;  ///< of the cycle seen last
  std::optional<WorstMotion> worst;
  std::array<double, kStreams> rates_hz{};  ///< samples in a second of the session's own time
  double silent_s = 0.0;                    ///< since a new cycle was last seen
};

/// Of one thread.
class PageFinder {
 public:
  explicit PageFinder(const Session& session);

  /// Takes the newest cycle, whether somebody watches or not. Returns whether it is a new one.
  bool Note(const PageSnapshot& snapshot);
  /// Finds the rest for those who watch: milliseconds, where the worst angle's turn has come.
  const PageFindings& Find(const PageSnapshot& snapshot);
  /// Returns the found moment next to `t_ns`, of the last second: late pictures are drawn over.
  const ShaftMoment& At(TimeNs t_ns) const;

 private:
  using Clock = std::chrono::steady_clock;
  void Count(TimeNs t_ns, const std::array<long, kStreams>& accepted);

  const Session& session_;
  TipController controller_;
  PageFindings findings_;
  std::deque<ShaftMoment> moments_;  // the newest last
  Clock::time_point heard_ = Clock::now();
  long noted_ = -1, found_ = -1;  // numbers of cycles
  int looks_ = 0;                 // since the worst angle was found
  TimeNs counted_from_ns_ = 0;
  std::array<long, kStreams> counted_{};
};

}  // namespace flextip::live
