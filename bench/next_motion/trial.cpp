#include "bench/next_motion/trial.h"

#include <algorithm>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "core/error.h"
#include "core/rotation.h"
#include "diagnosis/planning/imagined_samples.h"
#include "diagnosis/planning/tip_course.h"
#include "diagnosis/search/motion_library.h"
#include "recording/join.h"
#include "simulation/closed_loop/diagnosing_loop.h"
#include "simulation/closed_loop/scenario_run.h"
#include "testdata/hidden/draw.h"

namespace flextip::bench {
namespace {

using simulation::LoopResult;
using simulation::Scenario;

constexpr double kSeconds = 20.0, kNever = 40.0;
constexpr double kChecks_s[] = {0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 6.0, 9.0, 13.0, kSeconds};
constexpr double kPortForce = 4.0;  // of EI / L^2: the library's largest weight and bends
constexpr double kCertain = 0.95, kNotThere = 0.5;

double Uniform(std::mt19937_64& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

/// The scenarios have the tip by its figures.
bool NeedsCamera(const std::string& effect) {
  return effect == "focal_length" || effect == "lens_radial";
}

/// An effect that the scenario's sensors could show.
std::string DrawEffect(const Scenario& scenario, std::mt19937_64& rng) {
  std::vector<std::string> effects;
  for (const std::string& effect : simulation::CatalogueEffects()) {
    const std::string sensor = hidden::SensorOf(effect);
    if (sensor == "strain0" && !scenario.loop.sensors.strain) continue;
    if (NeedsCamera(effect)) continue;
    effects.push_back(effect);
  }
  return effects[std::uniform_int_distribution<std::size_t>(0, effects.size() - 1)(rng)];
}

void Hide(const std::string& effect, std::mt19937_64& rng, Scenario& scenario) {
  simulation::LoopSetup& loop = scenario.loop;
  const Eigen::Vector3d axis = (loop.base.p_RP - loop.p_RW_start).normalized();
  hidden::HiddenLabel label = hidden::DrawEffects({.present = {effect}, .mean_axis = axis}, rng);
  std::erase_if(label.parameters, [](const auto& one) { return NeedsCamera(one.first); });
  const auto effects = simulation::EffectsOfWholeMass(label.parameters, loop.base.instrument);
  loop.plant.effects = effects.plant;
  const Eigen::Vector3d centre_m = loop.sensor_effects.em_centre_m;
  loop.sensor_effects = effects.sensors;
  loop.sensor_effects.em_centre_m = centre_m;
}

/// A way to move on: the tip's places and the weight that hangs from it.
diagnosis::NextMotion RandomMotion(const diagnosis::SampleSet& recorded,
                                   const diagnosis::MotionLimits& limits, std::mt19937_64& rng) {
  diagnosis::NextMotion motion;
  const Eigen::Matrix3d R_mean = diagnosis::MeanShaftFrame(recorded);
  const double unit_N =
      recorded.instrument.bending_stiffness_Nm2 / std::pow(recorded.instrument.length_m, 2);
  const double weights[] = {0.0, 0.4, 1.2};
  motion.load_N = unit_N * weights[std::uniform_int_distribution<int>(0, 2)(rng)];
  std::vector<Eigen::Vector3d> places;
  for (double seconds = 0.0; seconds < kSeconds;) {
    const double inserted = Uniform(rng, *limits.inserted_from_m, *limits.inserted_to_m);
    const double radius = *limits.angle_rad * std::sqrt(Uniform(rng, 0.0, 1.0));
    const double angle = Uniform(rng, 0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d axis =
        R_mean.rightCols<2>() * Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
    places.emplace_back(recorded.p_RP + inserted * (ExpRotation(axis) * R_mean.col(0)));
    if (places.size() < 2) continue;
    const diagnosis::TipCourse course(places, recorded.p_RP, recorded.instrument.length_m,
                                      *limits.wrist_speed_m_s);
    seconds = course.Seconds();
    motion.speed_m_s = course.Speed();
  }
  motion.places_m = places;
  return motion;
}

diagnosis::NextMotion LibraryMotionOf(const diagnosis::NextMotion& plan,
                                      const diagnosis::SampleSet& recorded) {
  diagnosis::NextMotion motion;
  for (const diagnosis::LibraryMotion& one : diagnosis::MotionLibrary(recorded)) {
    if (one.text != plan.library_motion) continue;
    motion.places_m = one.places_m;
    motion.load_N = one.load_N;
  }
  double way_m = 0.0;
  for (std::size_t i = 1; i < motion.places_m.size(); ++i)
    way_m += (motion.places_m[i] - motion.places_m[i - 1]).norm();
  motion.speed_m_s = std::max(1e-3, way_m / kSeconds);
  return motion;
}

/// What the first motion leaves.
struct Begun {
  Scenario scenario;
  std::string effect;
  LoopResult first;
};

LoopResult Moved(const Begun& begun, const diagnosis::NextMotion& motion,
                 const Eigen::Vector3d& p_RW, int round, double seconds) {
  Scenario next = simulation::NextScenario(begun.scenario, motion, p_RW, round);
  next.loop.max_s = seconds;
  return simulation::RunController(next, next.controllers.front(), nullptr);
}

/// Whether the answer to all motions together is certain, and right.
bool IsCertain(const Begun& begun, const diagnosis::DiagnosisResult& answer) {
  for (const auto& [name, presence] : answer.presence)
    if (name == begun.effect ? presence < kCertain : presence > kNotThere) return false;
  return answer.presence.contains(begun.effect);
}

/// By one motion, as long as need be.
double SecondsByOne(const Begun& begun, const diagnosis::NextMotion& motion) {
  for (const double seconds : kChecks_s) {
    const LoopResult run = Moved(begun, motion, begun.first.updates.back().p_RW, 1, seconds);
    const auto answer =
        diagnosis::Diagnose(Join({&begun.first.recording, &run.recording}), "both",
                            {.without = {}, .discover = false, .measure_gain = false});
    if (IsCertain(begun, answer)) return seconds;
  }
  return kNever;
}

/// By a plan to its end, and by a new one where that leaves a doubt, as `simulate --diagnose`.
double SecondsByPlans(const Begun& begun, diagnosis::NextMotion plan,
                      const diagnosis::MotionLimits& limits) {
  Recording before = begun.first.recording;  // of the plan
  int round = 1;
  Eigen::Vector3d p_RW = begun.first.updates.back().p_RW;
  double before_s = 0.0;
  for (const double seconds : kChecks_s) {
    const LoopResult run = Moved(begun, plan, p_RW, round, seconds - before_s);
    const Recording all = Join({&before, &run.recording});
    const auto answer = diagnosis::Diagnose(
        all, "all", {.without = {}, .discover = false, .measure_gain = false, .plan = limits});
    if (IsCertain(begun, answer)) return seconds;
    const auto& next = answer.plan;
    const bool is_over = seconds - before_s >= plan.seconds;
    if (!is_over || !next || next->places_m.size() < 2) continue;  // the same motion goes on
    plan = *next;
    before = all;
    before_s = seconds;
    p_RW = run.updates.back().p_RW;
    ++round;
  }
  return kNever;
}

}  // namespace

TrialRecord RunTrial(const std::filesystem::path& file, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  Begun begun{.scenario = simulation::ReadScenario(file), .effect = {}, .first = {}};
  begun.effect = DrawEffect(begun.scenario, rng);
  begun.scenario.loop.seed = seed;
  TrialRecord record{.key = fmt::format("seed_{}", seed), .effect = begun.effect};
  try {
    Hide(begun.effect, rng, begun.scenario);
    begun.first =
        simulation::RunController(begun.scenario, begun.scenario.controllers.front(), nullptr);
    const Instrument& instrument = begun.scenario.loop.base.instrument;
    const double unit_N = instrument.bending_stiffness_Nm2 / std::pow(instrument.length_m, 2);
    const auto limits = simulation::LimitsOf(
        begun.scenario, {.seconds = kSeconds,
                         .wrist_speed_m_s = begun.scenario.loop.servo.max_speed_m_s,
                         .port_force_N = kPortForce * unit_N});
    const auto told = diagnosis::Diagnose(
        begun.first.recording, "first",
        {.without = {}, .discover = false, .measure_gain = false, .plan = limits});
    const diagnosis::NextMotion& plan = *told.plan;
    if (!plan.needed || plan.places_m.size() < 2) {
      record.why = fmt::format("{}: {}", !plan.needed ? "told by the first motion" : "no plan",
                               diagnosis::Joined(told.verdict));
      return record;
    }
    record.qualifies = true;
    for (const auto& rival : plan.rivals) record.rivals.push_back(diagnosis::Joined(rival));
    record.planned_seconds = plan.seconds_to_certain.value_or(kNever);
    const auto recorded = diagnosis::MakeSampleSet(begun.first.recording, "first");
    const std::map<std::string, diagnosis::NextMotion> ways{
        {"planned", plan},
        {"library", LibraryMotionOf(plan, recorded)},
        {"random", RandomMotion(recorded, limits, rng)}};
    for (const auto& [name, motion] : ways) {
      record.load_N[name] = motion.load_N;
      record.seconds[name] =
          name == "planned" ? SecondsByPlans(begun, motion, limits) : SecondsByOne(begun, motion);
    }
  } catch (const InputError& error) {
    record.qualifies = false;
    record.why = error.what();
  } catch (const WorkError& error) {
    record.qualifies = false;
    record.why = error.what();
  }
  return record;
}

}  // namespace flextip::bench
