#include "stops/stop_facts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "stops/sensor_tips.h"

namespace flextip {
namespace {

constexpr TimeNs kApart_ns = 9'000'000;       // of two moments whose tips are looked for
constexpr TimeNs kBefore_ns = 1'000'000'000;  // a vote so long before the hold led to it
constexpr TimeNs kNewest_ns = 500'000'000;    // an older tip is none

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

std::size_t IndexAt(const std::vector<Moment>& moments, TimeNs t_ns) {
  const auto at = std::lower_bound(moments.begin(), moments.end(), t_ns,
                                   [](const Moment& m, TimeNs t) { return m.t_ns < t; });
  return static_cast<std::size_t>(std::min(at, moments.end() - 1) - moments.begin());
}

/// A tip counts while it is new enough, whoever uses it.
SensorReadings Fresh(const Moment& moment) {
  SensorReadings readings = moment.readings;
  if (readings.tip && moment.t_ns - readings.tip->t_ns > kNewest_ns) readings.tip.reset();
  return readings;
}

/// The sensor that was voted out at the hold's begin, or last before.
void FindNamed(const std::vector<Moment>& moments, std::size_t at, StopFacts& facts) {
  for (std::size_t i = at + 1; i-- > 0;) {
    if (moments[at].t_ns - moments[i].t_ns > kBefore_ns) return;
    const std::uint8_t out = moments[i].supervision.voted_out;
    if (out == 0) continue;
    facts.odd = static_cast<VotedSensor>(std::countr_zero(out));
    facts.odd_is_named = true;
    return;
  }
}

/// Without a name: the sensor without which the others agree best, where all together do not.
void FindOddest(SensorTips& tips, StopFacts& facts) {
  if (facts.odd || !(facts.chi2 > facts.chi2_limit)) return;
  double least = facts.chi2;
  for (int i = 0; i < kVotedSensors; ++i) {
    if ((tips.Sensors() >> i & 1) == 0) continue;
    const auto rest = tips.Without(static_cast<VotedSensor>(i));
    if (!rest.fitted || rest.chi2 >= least) continue;
    least = rest.chi2;
    facts.odd = static_cast<VotedSensor>(i);
  }
}

void AddOthers(std::uint8_t sensors, StopFacts& facts) {
  for (int i = 0; i < kVotedSensors; ++i) {
    const auto sensor = static_cast<VotedSensor>(i);
    if ((sensors >> i & 1) != 0 && sensor != facts.odd) facts.others.push_back(sensor);
  }
}

/// The distance of the tip by the odd sensor from the tip by the others at the hold's begin, or
/// shortly before. A late tip stands beside the others' tip of its own time.
double OddDistance(const std::vector<SeenMoment>& seen, std::size_t at, VotedSensor odd) {
  for (std::size_t i = at + 1; i-- > 0;) {
    const SeenMoment& now = seen[i];
    if (seen[at].moment.t_ns - now.moment.t_ns > kNewest_ns) break;
    const auto& p_RE = now.p_RE[static_cast<std::size_t>(odd)];
    if (!p_RE) continue;
    TimeNs t_ns = now.moment.t_ns;
    if (odd == VotedSensor::kTip) t_ns = now.moment.readings.tip->t_ns;
    const SeenMoment* nearest = nullptr;
    for (std::size_t k = i + 1; k-- > 0;) {
      if (!seen[k].p_RE_rest) continue;
      const auto apart = [&](const SeenMoment& m) { return std::abs(m.moment.t_ns - t_ns); };
      if (nearest != nullptr && apart(seen[k]) > apart(*nearest)) break;
      nearest = &seen[k];
    }
    if (nearest != nullptr) return (*p_RE - *nearest->p_RE_rest).norm();
  }
  return 0.0;
}

/// The size of the last step of the tip's sensor.
double TipJump(const std::vector<Moment>& moments, std::size_t at) {
  const auto& now = moments[at].readings.tip;
  if (!now) return 0.0;
  for (std::size_t i = at; i-- > 0;) {
    const auto& before = moments[i].readings.tip;
    if (before && before->t_ns < now->t_ns)
      return (now->value.tip.p_RE - before->value.tip.p_RE).norm();
  }
  return 0.0;
}

void FillNumbers(const StoppedRun& run, const std::vector<Moment>& moments, std::size_t at,
                 StopFacts& facts) {
  const Moment& now = moments[at];
  facts.worst_angle_rad = now.supervision.worst_angle_rad;
  facts.worst_angle_limit_rad = run.max_motion_angle_rad;
  facts.force_N = now.f_tip_N.norm();
  facts.force_limit_N = run.max_tip_force_N;
  facts.jump_m = TipJump(moments, at);
  if (at > 0 && now.readings.wrist && moments[at - 1].p_RW_sent)
    facts.wrist_off_m = (now.readings.wrist->value.p_RW - *moments[at - 1].p_RW_sent).norm();
  // The vote's numbers of the hold's begin, or of the last cycle with a vote.
  for (std::size_t i = at + 1; i-- > 0;) {
    const Supervision& found = moments[i].supervision;
    if (now.t_ns - moments[i].t_ns > kBefore_ns) break;
    if (found.chi2_limit == 0.0) continue;
    facts.chi2 = found.chi2;
    facts.chi2_limit = found.chi2_limit;
    break;
  }
}

SensorTips TipsOf(const StoppedRun& run) {
  return {run.estimator, run.model ? run.model() : nullptr};
}

}  // namespace

StopStory TellStop(const StoppedRun& run, const StopEvent& stop,
                   const std::vector<Moment>& moments) {
  StopStory story;
  StopFacts& facts = story.facts;
  facts.cause = stop.cause;
  facts.at_s = Seconds(stop.begin_ns - run.start_ns);
  if (stop.IsFault()) facts.fault_s = Seconds(stop.fault_ns - run.start_ns);
  facts.end_s = Seconds(stop.end_ns - run.start_ns);
  facts.open = stop.open;
  facts.holds = stop.holds;
  if (moments.empty()) return story;
  const std::size_t at = IndexAt(moments, stop.begin_ns);
  FillNumbers(run, moments, at, facts);
  FindNamed(moments, at, facts);
  SensorTips at_begin = TipsOf(run);
  at_begin.Take(moments[at].t_ns, Fresh(moments[at]), moments[at].f_tip_N);
  FindOddest(at_begin, facts);
  AddOthers(at_begin.Sensors(), facts);

  SensorTips tips = TipsOf(run);
  TimeNs last_ns = std::numeric_limits<TimeNs>::min() / 2;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    SeenMoment seen{moments[k], {}, {}, 0};
    tips.Take(seen.moment.t_ns, Fresh(seen.moment), seen.moment.f_tip_N);
    seen.sensors = tips.Sensors();
    if (seen.moment.t_ns - last_ns >= kApart_ns || k == at) {
      last_ns = seen.moment.t_ns;
      for (int i = 0; i < kVotedSensors; ++i)
        seen.p_RE[static_cast<std::size_t>(i)] = tips.By(static_cast<VotedSensor>(i));
      if (facts.odd) seen.p_RE_rest = tips.Without(*facts.odd).p_RE;
    }
    story.moments.push_back(std::move(seen));
  }
  if (facts.odd) facts.odd_distance_m = OddDistance(story.moments, at, *facts.odd);
  return story;
}

}  // namespace flextip
