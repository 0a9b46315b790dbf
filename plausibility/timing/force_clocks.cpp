#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plausibility/relations/bending.h"
#include "plausibility/timing/clocks.h"
#include "plausibility/timing/lag.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Vector3d> Padded(const std::optional<Vector2d>& v) {
  if (!v) return {};
  return Vector3d(v->x(), v->y(), 0.0);
}

class ForceClockCheck {
 public:
  ForceClockCheck(const Recording& recording, const std::set<std::string>& unknown, Shifts& shifts)
      : recording_(recording),
        unknown_(unknown),
        shifts_(shifts),
        settings_(TakeScene(recording, shifts, 0)) {}

  void Run() {
    if (!recording_.wrist0 || recording_.wrist0->samples.size() < 60) return;
    if (shifts_.contains("wrist0") || unknown_.contains("port") || unknown_.contains("length"))
      return;
    const bool strain = recording_.strain0.has_value() && !unknown_.contains("strain0");
    if (strain && !shifts_.contains("strain0")) Strain();
    if (recording_.load0 && !shifts_.contains("load0")) Load(strain);
  }

  std::vector<Finding> findings;

 private:
  void Strain() {
    const auto lag =
        LagOf([](const Scene& s, const Instant& i) { return Padded(TurnSeen(s, i)); },
              [](const Scene& s, const Instant& i) { return Padded(TurnByMoments(s, i)); });
    if (lag) Add("strain0", "moments and bending", *lag);
  }

  void Load(bool strain) {
    std::optional<Lag> lag;
    if (strain) {
      lag = LagOf(
          [](const Scene& s, const Instant& i) -> std::optional<Vector3d> {
            if (!i.strain_Nm || !TurnSeen(s, i)) return {};
            return Padded(Vector2d(i.strain_Nm->tail<2>()));
          },
          [](const Scene& s, const Instant& i) { return Padded(MomentByLoad(s, i)); });
    } else {
      lag = LagOf(DeflectionSeen, DeflectionByLoad);
    }
    if (lag) Add("load0", "load and bending", *lag);
  }

  using OfInstant = std::function<std::optional<Vector3d>(const Scene&, const Instant&)>;

  std::optional<Lag> LagOf(const OfInstant& a, const OfInstant& b) const {
    const auto at = [&](const OfInstant& of) -> VectorAt {
      return [this, of](TimeNs t) -> std::optional<Vector3d> {
        const Instant now = InstantAt(recording_, t, shifts_);
        return now.wrist ? of(settings_, now) : std::nullopt;
      };
    };
    constexpr double kReach_s = 10.0, kLatency_s = 0.25;
    const auto& samples = recording_.wrist0->samples;
    const auto lag =
        FindLag(at(a), at(b), {samples.front().t_ns, samples.back().t_ns, 0.0, kReach_s});
    if (!lag || std::abs(lag->seconds) < kLatency_s || !lag->IsClear()) return {};
    return lag;
  }

  void Add(const std::string& stream, const std::string& what, const Lag& lag) {
    findings.push_back(ClockFinding(
        stream, lag.seconds,
        fmt::format("{} agree to {:.0f} % with this offset, to {:.0f} % without", what,
                    100.0 * lag.correlation, 100.0 * std::max(0.0, lag.correlation_at_zero))));
    shifts_[stream] = -lag.seconds;
  }

  const Recording& recording_;
  const std::set<std::string>& unknown_;
  Shifts& shifts_;
  Scene settings_;  // without instants
};

}  // namespace

std::vector<Finding> CheckForceClocks(const Recording& recording,
                                      const std::set<std::string>& unknown, Shifts& shifts) {
  ForceClockCheck check(recording, unknown, shifts);
  check.Run();
  return check.findings;
}

}  // namespace flextip::plausibility
