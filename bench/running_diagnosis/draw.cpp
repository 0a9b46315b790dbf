#include "bench/running_diagnosis/draw.h"

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <random>

#include "bench/fault_campaign/healthy.h"
#include "core/draw_vector.h"
#include "diagnosis/running/running_diagnosis.h"

namespace flextip::bench {
namespace {

using Rng = std::mt19937_64;
using simulation::EffectsOnset;

constexpr double kRoom_m = 0.012;  // of the path about the tip's start
constexpr double kFirstOnset_s = 20.0, kOnsetSpan_s = 20.0;

Eigen::Vector3d Direction(Rng& rng) {
  std::normal_distribution<double> normal;
  return DrawVector<3>(normal, rng).normalized();
}
double Sign(Rng& rng) { return std::bernoulli_distribution()(rng) ? 1.0 : -1.0; }

struct Cause {
  double typical = 0.0;  ///< as in the diagnosis
  bool needs_em = false, needs_all = false;
  void (*set)(double size, Rng& rng, EffectsOnset& onset) = nullptr;
  std::optional<simulation::FaultStream> drifts = std::nullopt;  ///< typical: a second
};

const std::map<std::string, Cause>& Causes() {
  static const std::map<std::string, Cause> causes{
      {"port_compliance",
       {0.0008, false, false,
        [](double size, Rng&, EffectsOnset& o) { o.plant.port_compliance_m_N += size; }}},
      {"port_offset",
       {0.003, false, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.plant.port_offset_m += size * Direction(rng);
        }}},
      {"stiffness",
       {0.2, false, true,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.plant.stiffness_scale *= std::exp(Sign(rng) * size);
        }}},
      {"em_offset",
       {0.003, true, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.sensors.em_offset_m += size * Direction(rng);
        }}},
      {"hand_eye",
       {0.003, false, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.sensors.hand_eye_translation_m += size * Direction(rng);
        }}},
      {"tag_offset",
       {0.002, false, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.sensors.tag_offset_m += size * Direction(rng);
        }}},
      {"precurvature",
       {0.1, false, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.plant.curvature_1_m += size * Direction(rng).head<2>().normalized();
        }}},
      {"port_friction",
       {0.3, false, false,
        [](double size, Rng&, EffectsOnset& o) { o.plant.port_friction.coefficient += size; }}},
      {"shaft_load",
       {0.4, false, false,
        [](double size, Rng& rng, EffectsOnset& o) {
          o.plant.shaft_load_N_m += size * Direction(rng);
        }}},
      {"backlash",
       {0.001, false, false,
        [](double size, Rng&, EffectsOnset& o) { o.plant.backlash_m += size; }}},
      {"camera_latency",
       {0.04, false, false,
        [](double size, Rng&, EffectsOnset& o) { o.sensors.camera_latency_s += size; }}},
      {"strain_gain",
       {0.15, false, true,
        [](double size, Rng& rng, EffectsOnset& o) {
          const int gage = std::uniform_int_distribution<int>(0, 3)(rng);
          o.sensors.strain_gain[gage] *= 1.0 + Sign(rng) * size;
        }}},
      // 0.04, 0.12 and 0.4 mm/s
      {"tip_drift", {0.0002, false, false, nullptr, simulation::FaultStream::kTip}},
      {"em_drift", {0.0002, true, false, nullptr, simulation::FaultStream::kEm0}},
  };
  return causes;
}

/// Goes on to places about the start until the time is over.
void DrawPath(Rng& rng, double duration_s, PathSetup& path) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  path.waypoints_m.clear();
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (double way_m = 0.0; way_m < path.speed_m_s * (duration_s + 1.0);) {
    const Eigen::Vector3d next = kRoom_m * DrawVector<3>(unit, rng);
    way_m += (next - last).norm();
    path.waypoints_m.push_back(last = next);
  }
}

}  // namespace

const std::vector<std::string>& OnsetCauses() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, cause] : Causes()) all.push_back(name);
    return all;
  }();
  return names;
}

WatchedRun DrawWatched(std::uint64_t seed, int number, Suite suite, double duration_s,
                       double false_alarms_per_hour) {
  HealthyRun healthy = DrawHealthyRun(seed, number);
  Rng rng(healthy.base.seed);
  WatchedRun run;
  run.suite = suite;
  healthy.base.suite = run.suite;
  healthy.base.controller = ControllerKind::kRodTrack;
  const simulation::LoopSetup suited = SetupOf(healthy.base);
  run.setup = healthy.setup;
  run.setup.sensors = suited.sensors;
  run.setup.controller = suited.controller;
  run.setup.max_s = duration_s;
  DrawPath(rng, duration_s, run.setup.path);
  run.setup.watch = [base = run.setup.base, false_alarms_per_hour] {
    return std::make_unique<diagnosis::RunningDiagnosis>(
        base, diagnosis::RunningOptions{.false_alarms_per_hour = false_alarms_per_hour});
  };
  return run;
}

WatchedRun DrawOnset(std::uint64_t seed, int number, const std::string& name, int size,
                     double duration_s, double false_alarms_per_hour) {
  const Cause& cause = Causes().at(name);
  // The suites that can tell, in turn; the move goes with the number.
  const int fewest = static_cast<int>(cause.needs_all  ? Suite::kAll
                                      : cause.needs_em ? Suite::kVisionEm
                                                       : Suite::kVision);
  const int suite = fewest + (number + number / kMoves) % (kSuites - fewest);
  WatchedRun run =
      DrawWatched(seed, number, static_cast<Suite>(suite), duration_s, false_alarms_per_hour);
  Rng rng(run.setup.seed + 1);
  run.cause = name;
  run.size = size;
  run.onset_s = kFirstOnset_s + kOnsetSpan_s * std::uniform_real_distribution<double>()(rng);
  if (cause.drifts) {
    run.setup.faults.push_back({simulation::FaultKind::kDrift, *cause.drifts, run.onset_s,
                                duration_s, kOnsetSizes[size] * cause.typical});
    run.setup.fault_seed = run.setup.seed;
  } else {
    run.setup.onset = {run.onset_s, run.setup.plant.effects, run.setup.sensor_effects};
    cause.set(kOnsetSizes[size] * cause.typical, rng, *run.setup.onset);
  }
  return run;
}

}  // namespace flextip::bench
