#include "plausibility/timing/clocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "plausibility/timing/lag.h"
#include "plausibility/timing/lag_choice.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

/// Returns the share of the shorter stream that lies within the other.
double Overlap(const Rows& a, const Rows& b) {
  const double shorter = std::min(SecondsBetween(a.t_ns.front(), a.t_ns.back()),
                                  SecondsBetween(b.t_ns.front(), b.t_ns.back()));
  const double common = SecondsBetween(std::max(a.t_ns.front(), b.t_ns.front()),
                                       std::min(a.t_ns.back(), b.t_ns.back()));
  if (!(shorter > 0.0)) return common >= 0.0 ? 1.0 : 0.0;
  return std::max(0.0, common) / shorter;
}

/// Speed over 0.2 s: the same in every frame.
VectorAt SpeedOf(std::function<std::optional<Vector3d>(TimeNs)> place) {
  return [place = std::move(place)](TimeNs t) -> std::optional<Vector3d> {
    constexpr TimeNs kHalf_ns = 100'000'000;
    const auto before = place(t - kHalf_ns), after = place(t + kHalf_ns);
    if (!before || !after) return {};
    return Vector3d((*after - *before).norm(), 0.0, 0.0);
  };
}

class ClockCheck {
 public:
  ClockCheck(const Recording& recording, const std::vector<Rows>& rows,
             const std::set<std::string>& unknown, Shifts& shifts, Shifts& supposed)
      : recording_(recording),
        rows_(rows),
        unknown_(unknown),
        shifts_(shifts),
        supposed_(supposed) {}

  void Run() {
    const Rows* wrist = FindRows(rows_, "wrist0");
    if (wrist == nullptr) return;
    Meet(*wrist);
    if (shifts_.contains("wrist0")) return;
    if (IsMotionResolved(*wrist)) CompareMotion();
    for (const auto& [name, finding] : doubtful_) {
      if (!shifts_.contains(name) && !confirmed_.contains(name)) {
        findings.push_back(finding);
      } else {
        supposed_.erase(name);
      }
    }
  }

  std::vector<Finding> findings;

 private:
  void Wrong(const std::string& name, double ahead_s, const std::string& evidence) {
    findings.push_back(ClockFinding(name, ahead_s, evidence));
    shifts_[name] = -ahead_s;
  }

  /// Do the streams have common times, and is it the wrist's clock that is off, or their own?
  void Meet(const Rows& wrist) {
    std::vector<std::pair<std::string, double>> apart, hardly;
    std::size_t others = 0;
    double most_overlap = 0.0;
    for (const Rows& r : rows_) {
      if (r.name == "wrist0") continue;
      ++others;
      const double ahead_s = SecondsBetween(wrist.t_ns.front(), r.t_ns.front());
      const double overlap = Overlap(r, wrist);
      most_overlap = std::max(most_overlap, overlap);
      if (overlap < kLeastOverlap) hardly.emplace_back(r.name, ahead_s);
      if (overlap <= 0.0) {
        apart.emplace_back(r.name, ahead_s);
      } else {
        Doubt(r, wrist, overlap);
      }
    }
    const auto how = [](const std::string& name, double ahead_s) {
      return fmt::format("{} and wrist0 begin {} apart and do not meet", name,
                         DurationText(std::abs(ahead_s)));
    };
    if (others > 1 && hardly.size() == others && AreAlike(hardly)) {
      doubtful_.clear(), supposed_.clear();
      if (apart.empty()) {
        doubtful_.emplace("wrist0", HardlyMeets("wrist0", "the other streams'", most_overlap));
        supposed_["wrist0"] = AheadOfWrist(hardly);
      } else {
        Wrong("wrist0", -AheadOfWrist(apart), how(apart.front().first, apart.front().second));
      }
      return;
    }
    for (const auto& [name, ahead_s] : apart) {
      const auto lag = LagOf(name, ahead_s, kStart_s);
      Wrong(name, lag && lag->correlation > kMoveAlike ? lag->seconds : ahead_s,
            how(name, ahead_s));
    }
  }

  /// By the stream whose motion shows it best, else by the first sample's.
  double AheadOfWrist(const std::vector<std::pair<std::string, double>>& apart) const {
    double ahead_s = apart.front().second, best = kMoveAlike;
    for (const auto& [name, start_s] : apart) {
      const auto lag = LagOf(name, start_s, kStart_s);
      if (lag && lag->correlation > best) best = lag->correlation, ahead_s = lag->seconds;
    }
    return ahead_s;
  }

  static bool AreAlike(const std::vector<std::pair<std::string, double>>& apart) {
    const double first = apart.front().second;
    return std::all_of(apart.begin(), apart.end(), [&](const auto& a) {
      return std::abs(a.second - first) < 1.0 + 0.01 * std::abs(first);
    });
  }

  /// Streams that meet the wrist, but look as if by chance.
  void Doubt(const Rows& rows, const Rows& wrist, double overlap) {
    // Streams of one program begin apart as well: only a later start tells.
    constexpr double kLate_s = 1.0, kLateShare = 0.2;
    const double late_s =
        std::max(kLate_s, kLateShare * SecondsBetween(wrist.t_ns.front(), wrist.t_ns.back()));
    const double start_s = 1e-9 * static_cast<double>(rows.t_ns.front());
    const double wrist_s = 1e-9 * static_cast<double>(wrist.t_ns.front());
    const auto counts_from_zero = [](const Rows& r, double s) {
      return std::abs(s) < 1.5 * MedianStep_s(r);
    };
    if (counts_from_zero(rows, start_s) && wrist_s > late_s) {
      Finding finding = ClockFinding(
          rows.name, start_s - wrist_s,
          fmt::format("its times start at 0, those of wrist0 at {}: they look counted from the "
                      "stream's own start",
                      DurationText(wrist_s)));
      finding.severity = Severity::kDoubtful;
      supposed_[rows.name] = wrist_s - start_s;
      doubtful_.emplace(rows.name, std::move(finding));
    } else if (overlap < kLeastOverlap) {
      doubtful_.emplace(rows.name, HardlyMeets(rows.name, "wrist0's", overlap));
    }
  }

  static Finding HardlyMeets(const std::string& name, const std::string& whose, double overlap) {
    return {
        Severity::kDoubtful, name + ".clock",
        fmt::format("{}: {:.0f} % of its time is {} time as well", name, 100.0 * overlap, whose),
        fmt::format("import with --offset {}=SECONDS where its clock is another one", name)};
  }

  static bool IsMotionResolved(const Rows& wrist) {
    const double duration = SecondsBetween(wrist.t_ns.front(), wrist.t_ns.back());
    return wrist.t_ns.size() >= 40 && duration > 1.0 &&
           static_cast<double>(wrist.t_ns.size()) / duration > 5.0;
  }

  void CompareMotion() {
    std::vector<std::pair<std::string, Lag>> late;
    std::vector<std::vector<Lag>> all;
    for (const std::string name : {"em0", "vision0", "command0"}) {
      if (shifts_.contains(name)) continue;
      const std::vector<Lag> lags = LagsOf(name, 0.0, kReach_s);
      const auto lag = ChooseLag(recording_, name, lags, shifts_, unknown_);
      if (!lag) continue;
      constexpr double kAlike = 0.85;
      all.push_back(lags);
      if (lag->correlation_at_zero > kAlike) confirmed_.insert(name);
      if (std::abs(lag->seconds) >= kLatency_s && lag->IsClear()) late.emplace_back(name, *lag);
    }
    const auto how = [](const Lag& lag) {
      return fmt::format("the speeds agree to {:.0f} % with this offset, to {:.0f} % without",
                         100.0 * lag.correlation, 100.0 * std::max(0.0, lag.correlation_at_zero));
    };
    if (late.empty()) return;
    // The wrist is what they have in common. One clear lag is enough where the others, too, go
    // better with it than without.
    const auto clearest = std::max_element(late.begin(), late.end(), [](auto& x, auto& y) {
      return x.second.correlation < y.second.correlation;
    });
    const Lag& lag_of_wrist = clearest->second;
    const auto agrees = [&](const std::vector<Lag>& lags) {
      return std::any_of(lags.begin(), lags.end(), [&](const Lag& lag) {
        return std::abs(lag.seconds - lag_of_wrist.seconds) < 0.2 &&
               lag.correlation > lag.correlation_at_zero;
      });
    };
    const bool all_agree = all.size() > 1 && std::all_of(all.begin(), all.end(), agrees);
    if (all_agree || doubtful_.contains("wrist0"))
      return Wrong("wrist0", -lag_of_wrist.seconds, how(lag_of_wrist));
    for (const auto& [name, lag] : late) Wrong(name, lag.seconds, how(lag));
  }

  std::optional<Lag> LagOf(const std::string& name, double around_s, double reach_s) const {
    return ChooseLag(recording_, name, LagsOf(name, around_s, reach_s), shifts_, unknown_,
                     around_s);
  }

  std::vector<Lag> LagsOf(const std::string& name, double around_s, double reach_s) const {
    const Rows& wrist = *FindRows(rows_, "wrist0");
    if (name != "em0" && name != "vision0" && name != "command0") return {};
    if (!IsMotionResolved(wrist) || FindRows(rows_, name) == nullptr) return {};
    if (name != "command0" && (unknown_.contains("port") || unknown_.contains("length"))) return {};
    const LagSearch search{wrist.t_ns.front(), wrist.t_ns.back(), around_s, reach_s};
    return FindLags(SpeedOf([&](TimeNs t) { return ExpectedPlace(name, t); }),
                    SpeedOf([&](TimeNs t) { return PlaceAt(recording_, name, t); }), search);
  }

  /// Where the straight shaft has the stream's place.
  std::optional<Vector3d> ExpectedPlace(const std::string& name, TimeNs t_ns) const {
    const auto wrist = PlaceAt(recording_, "wrist0", t_ns);
    if (!wrist || name == "command0") return wrist;
    const double length = recording_.instrument.length_m;
    const double s = name == "em0" ? length - recording_.em0->distance_from_tip_m : length;
    return Vector3d(*wrist + s * (recording_.p_RP - *wrist).normalized());
  }

  static constexpr double kReach_s = 60.0;
  static constexpr double kStart_s = 30.0;  // streams seldom begin at the same instant
  static constexpr double kMoveAlike = 0.8, kLeastOverlap = 0.5;

  const Recording& recording_;
  const std::vector<Rows>& rows_;
  const std::set<std::string>& unknown_;
  Shifts &shifts_, &supposed_;
  std::map<std::string, Finding> doubtful_;
  std::set<std::string> confirmed_;
};

}  // namespace

Finding ClockFinding(const std::string& stream, double ahead_s, const std::string& evidence) {
  const std::string amount = DurationText(std::abs(ahead_s));
  return {
      Severity::kWrong, stream + ".clock",
      fmt::format("{}: its clock is {} {} that of the other streams ({})", stream, amount,
                  ahead_s > 0.0 ? "ahead of" : "behind", evidence),
      fmt::format("import with --offset {}={:.9g}, or {} {} its time stamps", stream, -ahead_s,
                  ahead_s > 0.0 ? "subtract" : "add", amount + (ahead_s > 0.0 ? " from" : " to"))};
}

std::vector<Finding> CheckClocks(const Recording& recording, const std::vector<Rows>& rows,
                                 const std::set<std::string>& unknown, Shifts& shifts,
                                 Shifts& supposed) {
  ClockCheck check(recording, rows, unknown, shifts, supposed);
  check.Run();
  return check.findings;
}

}  // namespace flextip::plausibility
