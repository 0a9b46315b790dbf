#include "simulation/closed_loop/diagnosing_loop.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/check.h"
#include "recording/join.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip::simulation {
namespace {

constexpr double kSettle_s = 0.5;  // as a motion's file says
constexpr double kBrisk_m_s = 0.1, kLeastInserted = 0.35, kMostInserted = 0.75, kAngle_rad = 0.43;
constexpr double kTellsMore = 0.02;  // of probability

double SecondsOf(const LoopResult& run) {
  return 1e-9 * static_cast<double>(run.updates.back().t_ns - run.updates.front().t_ns);
}

/// What the round knows after `diagnosed`; whether it is the last one.
std::optional<DiagnosingEnd> Conclude(const diagnosis::DiagnosisResult& diagnosed,
                                      DiagnosingRound& round) {
  FLEXTIP_CHECK(diagnosed.plan.has_value(), "a plan was asked for");
  round.answer = diagnosed.verdict;
  round.probability = diagnosed.probabilities.front().probability;
  round.next = *diagnosed.plan;
  if (!round.next.needed) return DiagnosingEnd::kSeparated;
  const bool tells_more = round.next.seconds_to_certain ||
                          round.next.probability > round.next.probability_now + kTellsMore;
  if (round.next.places_m.size() < 2 || !tells_more) return DiagnosingEnd::kNoMotion;
  return {};
}

}  // namespace

double DiagnosingResult::Seconds() const {
  double sum = 0.0;
  for (const DiagnosingRound& round : rounds) sum += round.seconds;
  return sum;
}

diagnosis::MotionLimits LimitsOf(const Scenario& scenario, diagnosis::MotionLimits limits) {
  const double length_m = scenario.loop.base.instrument.length_m;
  if (!limits.wrist_speed_m_s)
    limits.wrist_speed_m_s = std::min(kBrisk_m_s, scenario.loop.servo.max_speed_m_s);
  if (!limits.inserted_from_m) limits.inserted_from_m = kLeastInserted * length_m;
  if (!limits.inserted_to_m) limits.inserted_to_m = kMostInserted * length_m;
  if (!limits.angle_rad) limits.angle_rad = kAngle_rad;
  return limits;
}

Scenario NextScenario(const Scenario& scenario, const diagnosis::NextMotion& motion,
                      const Eigen::Vector3d& p_RW, int round) {
  Scenario next = scenario;
  LoopSetup& loop = next.loop;
  loop.p_RW_start = p_RW;
  loop.path = {.frame = PathFrame::kRobot,
               .waypoints_m = motion.places_m,
               .speed_m_s = motion.speed_m_s,
               .settle_s = kSettle_s};
  loop.plant.load.constant_N += motion.load_N * loop.base.gravity_m_s2.normalized();
  loop.seed += static_cast<std::uint64_t>(round);
  if (loop.max_s > 0.0) loop.max_s += PathSeconds(loop) - PathSeconds(scenario.loop);
  return next;
}

DiagnosingResult DiagnoseInLoop(const Scenario& scenario, const DiagnosingOptions& options,
                                const std::function<void(const std::string&)>& progress) {
  const auto say = [&](const std::string& what) {
    if (progress) progress(what);
  };
  DiagnosingResult result;
  const diagnosis::DiagnoseOptions asked{.without = options.without,
                                         .plan = LimitsOf(scenario, options.limits)};
  Recording all;
  Scenario now = scenario;
  double hung_N = 0.0;
  for (int i = 1; i <= options.most_rounds; ++i) {
    DiagnosingRound round{.name = fmt::format("round_{}", i), .hung_N = hung_N};
    say(fmt::format("{}: moves", round.name));
    round.run = RunController(now, now.controllers.front(), nullptr);
    round.seconds = SecondsOf(round.run);
    const Recording& made = round.run.recording;
    all = i == 1 ? made : Join({&all, &made});
    say(fmt::format("{}: diagnoses", round.name));
    result.diagnosis = diagnosis::Diagnose(all, round.name, asked);
    const auto end = Conclude(result.diagnosis, round);
    result.rounds.push_back(std::move(round));
    if (end) {
      result.end = *end;
      break;
    }
    const DiagnosingRound& last = result.rounds.back();
    hung_N = last.next.load_N;
    now = NextScenario(scenario, last.next, last.run.updates.back().p_RW, i);
  }
  return result;
}

}  // namespace flextip::simulation
