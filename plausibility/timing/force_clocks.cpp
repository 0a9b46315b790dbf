#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plausibility/relations/bending.h"
#include "plausibility/relations/relations.h"
#include "plausibility/timing/clocks.h"
#include "plausibility/timing/lag.h"
#include "plausibility/timing/lag_choice.h"

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
  ForceClockCheck(const Recording& recording, const std::set<std::string>& unknown,
                  const Shifts& supposed, Shifts& shifts)
      : recording_(recording),
        unknown_(unknown),
        supposed_(supposed),
        shifts_(shifts),
        settings_(TakeScene(recording, shifts, 0)) {}

  void Run() {
    if (!recording_.wrist0 || recording_.wrist0->samples.size() < 60) return;
    if (shifts_.contains("wrist0") || supposed_.contains("wrist0")) return;
    if (unknown_.contains("port") || unknown_.contains("length")) return;
    const bool strain = recording_.strain0.has_value() && !unknown_.contains("strain0");
    if (!StreamsFit()) return;
    // Streams that do not meet the wrist have the offset of their starts so far.
    const bool known = !shifts_.contains("strain0") && !supposed_.contains("strain0");
    const bool found = strain && Strain();
    if (recording_.load0) Load(strain && (known || found));
  }

  std::vector<Finding> findings;

 private:
  /// What sees the bending has to be right: in another frame it bends at other times.
  bool StreamsFit() const {
    Scene scene = TakeScene(recording_, shifts_);
    scene.unknown = unknown_;
    scene.unknown.insert({"strain0", "load0"});
    return CountViolated(RelationsOf(scene)) == 0;
  }

  bool Strain() {
    const auto lag = LagOf(
        "strain0", [](const Scene& s, const Instant& i) { return Padded(TurnSeen(s, i)); },
        [](const Scene& s, const Instant& i) { return Padded(TurnByMoments(s, i)); });
    if (lag) Add("strain0", "moments and bending", *lag);
    return lag.has_value();
  }

  void Load(bool strain) {
    std::optional<Lag> lag;
    if (strain) {
      lag = LagOf(
          "load0",
          [](const Scene& s, const Instant& i) -> std::optional<Vector3d> {
            if (!i.strain_Nm || !TurnSeen(s, i)) return {};
            return Padded(Vector2d(i.strain_Nm->tail<2>()));
          },
          [](const Scene& s, const Instant& i) { return Padded(MomentByLoad(s, i)); });
    } else {
      lag = LagOf("load0", DeflectionSeen, DeflectionByLoad);
    }
    if (lag) Add("load0", "load and bending", *lag);
  }

  using OfInstant = std::function<std::optional<Vector3d>(const Scene&, const Instant&)>;

  /// Of the stream without its shift so far, around that.
  std::optional<Lag> LagOf(const std::string& stream, const OfInstant& a,
                           const OfInstant& b) const {
    Shifts shifts = supposed_;
    for (const auto& [name, shift_s] : shifts_) shifts[name] = shift_s;
    const double around_s = shifts.contains(stream) ? -shifts[stream] : 0.0;
    const auto at = [&](const OfInstant& of) -> VectorAt {
      return [this, of, &shifts](TimeNs t) -> std::optional<Vector3d> {
        const Instant now = InstantAt(recording_, t, shifts);
        return now.wrist ? of(settings_, now) : std::nullopt;
      };
    };
    constexpr double kReach_s = 10.0;
    const auto& samples = recording_.wrist0->samples;
    const auto lags =
        FindLags(at(a), at(b), {samples.front().t_ns, samples.back().t_ns, 0.0, kReach_s});
    auto lag = ChooseLag(recording_, stream, Later(lags, around_s), shifts_, unknown_, around_s);
    if (!lag || !lag->IsClear()) return {};
    if (-lag->correlation_at_zero >= lag->correlation) return {};  // a sign
    if (around_s == 0.0 && std::abs(lag->seconds) < kLatency_s) return {};
    return lag;
  }

  static std::vector<Lag> Later(std::vector<Lag> lags, double by_s) {
    for (Lag& lag : lags) lag.seconds += by_s;
    return lags;
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
  const Shifts& supposed_;
  Shifts& shifts_;
  Scene settings_;  // without instants
};

}  // namespace

std::vector<Finding> CheckForceClocks(const Recording& recording,
                                      const std::set<std::string>& unknown, const Shifts& supposed,
                                      Shifts& shifts) {
  ForceClockCheck check(recording, unknown, supposed, shifts);
  check.Run();
  return check.findings;
}

}  // namespace flextip::plausibility
