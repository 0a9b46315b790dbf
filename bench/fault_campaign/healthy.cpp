#include "bench/fault_campaign/healthy.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "batch/line_file.h"
#include "bench/fault_campaign/hazard.h"
#include "core/draw_vector.h"
#include "core/error.h"
#include "simulation/faults/fault.h"
#include "simulation/sensors/sensors.h"

namespace flextip::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HealthyRecord, kind, runs, without_equilibrium, simulated_s,
                                   stops, votes, off_path, limited_cycles, fine_stops, fine_s,
                                   stops_by_name, fine_stops_by_setting, examples)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HealthyBatch, name, records)

namespace {

using Rng = std::mt19937_64;
using simulation::LoopResult;

constexpr double kRoom_m = 0.012;  // about the tip's start
constexpr double kPath_m = 0.002;

double Uniform(Rng& rng, double from, double to) {
  return from + (to - from) * std::uniform_real_distribution<double>()(rng);
}

/// Within specification: normal, cut off at two standard deviations.
double Tolerance(Rng& rng, double sd) {
  std::normal_distribution<double> normal;
  double x = 3.0;
  while (std::abs(x) > 2.0) x = normal(rng);
  return sd * x;
}

Eigen::Vector3d ToleranceVector(Rng& rng, double sd) {
  Eigen::Vector3d v;
  for (double& x : v) x = Tolerance(rng, sd);
  return v;
}

/// A tour of some places about the start and back.
void DrawPath(Rng& rng, PathSetup& path) {
  path.waypoints_m.clear();
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 6; ++i) path.waypoints_m.emplace_back(kRoom_m * DrawVector<3>(unit, rng));
  path.waypoints_m.emplace_back(Eigen::Vector3d::Zero());
  path.speed_m_s = Uniform(rng, 0.004, 0.03);
  path.settle_s = Uniform(rng, 0.0, 1.0);
}

/// The tolerances of docs/effects.md, as far as they do not ask for latencies to be told.
void DrawPlant(Rng& rng, simulation::LoopSetup& setup) {
  simulation::PlantEffects& plant = setup.plant.effects;
  plant.stiffness_scale = 1.0 + Tolerance(rng, 0.02);
  plant.length_delta_m = Tolerance(rng, 0.0003);
  plant.mass_per_length_kg_m = std::abs(Tolerance(rng, 0.003));
  for (double& x : plant.curvature_1_m) x = Tolerance(rng, 0.003);
  plant.port_offset_m = ToleranceVector(rng, 0.0003);
  plant.port_motion.amplitude_m = ToleranceVector(rng, 0.0001);
  plant.port_motion.frequency_hz = Uniform(rng, 0.15, 0.35);
  plant.port_motion.phase_rad = Uniform(rng, 0.0, 6.28);
  plant.port_compliance_m_N = std::abs(Tolerance(rng, 0.00003));
  plant.port_friction.coefficient = std::abs(Tolerance(rng, 0.03));
  plant.shaft_load_N_m = ToleranceVector(rng, 0.02);
  plant.backlash_m = std::abs(Tolerance(rng, 0.0001));
  setup.plant.gravity_m_s2 = setup.base.gravity_m_s2;
  simulation::SensorEffects& sensors = setup.sensor_effects;
  sensors.em_offset_m = ToleranceVector(rng, 0.0002);
  sensors.hand_eye_translation_m = ToleranceVector(rng, 0.0002);
  for (double& x : sensors.strain_gain) x = 1.0 + Tolerance(rng, 0.01);
  for (double& x : sensors.strain_drift_Nm_s) x = Tolerance(rng, 0.00002);
}

double SimulatedTime(const LoopResult& result) {
  return 1e-9 * static_cast<double>(result.updates.back().t_ns - simulation::kSimulationStart_ns);
}

void Count(const HealthyRun& run, int number, bool fine, const LoopResult& result,
           HealthyRecord& record) {
  record.simulated_s += SimulatedTime(result);
  record.off_path += result.max_deviation_m > kPath_m;
  if (fine) record.fine_s += SimulatedTime(result);
  Supervision last;
  for (const simulation::LoopUpdate& update : result.updates) {
    const Supervision& now = update.supervision;
    record.limited_cycles += now.reaction == Reaction::kLimit;
    record.votes += now.voted_out != 0 && last.voted_out == 0;
    if (now.reaction >= Reaction::kHold && last.reaction < Reaction::kHold) {
      ++record.stops;
      ++record.stops_by_name[Name(now.stop)];
      record.fine_stops += fine;
      if (fine) {
        ++record.fine_stops_by_setting[fmt::format("{}, {}: {}", Name(run.base.controller),
                                                   Name(run.base.suite), Name(now.stop))];
      }
      const double t_s = 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
      if (fine && record.examples.size() < 4) {
        record.examples.push_back(fmt::format("{}: {} at {:.2f} s, run {}", run.base.Text(),
                                              Name(now.stop), t_s, number));
      }
    }
    last = now;
  }
}

}  // namespace

HealthyRun DrawHealthyRun(std::uint64_t first_seed, int number) {
  Rng rng(simulation::FaultSeed(first_seed, static_cast<std::size_t>(number)));
  HealthyRun run;
  run.base.move = static_cast<Move>(number % kMoves);
  run.base.controller = static_cast<ControllerKind>(number / kMoves % kControllerKinds);
  run.base.suite = static_cast<Suite>(number / (kMoves * kControllerKinds) % kSuites);
  run.base.seed = rng();
  run.setup = SetupOf(run.base);
  DrawPath(rng, run.setup.path);
  if (auto& tissue = run.setup.plant.load.tissue) {
    tissue->stiffness_N_m = Uniform(rng, 5.0, 60.0);
    tissue->tangential_stiffness_N_m = Uniform(rng, 0.0, 0.1) * tissue->stiffness_N_m;
  }
  DrawPlant(rng, run.setup);
  run.setup.resume_s = 0.0;  // a person looks once a second
  run.setup.max_s = 120.0;
  return run;
}

HealthyBatch RunHealthy(std::uint64_t first_seed, int first, double duration_s,
                        const std::vector<SupervisionKind>& kinds) {
  HealthyBatch one;
  for (const SupervisionKind kind : kinds) one.records.push_back({.kind = flextip::Name(kind)});
  for (int number = first; one.records.front().simulated_s < duration_s; ++number) {
    const HealthyRun run = DrawHealthyRun(first_seed, number);
    try {
      const LoopResult unsupervised = RunClosedLoop(run.setup, nullptr);
      const bool fine = unsupervised.max_deviation_m <= kPath_m;
      const double limit_m = DeviationLimitOf(unsupervised.max_deviation_m);
      for (std::size_t i = 0; i < kinds.size(); ++i) {
        HealthyRecord& record = one.records[i];
        ++record.runs;
        const bool none = kinds[i] == SupervisionKind::kNone;
        Count(run, number, fine,
              none
                  ? unsupervised
                  : RunClosedLoop(Supervised(run.setup, run.base.move, limit_m, kinds[i]), nullptr),
              record);
      }
    } catch (const WorkError&) {
      ++one.records.front().without_equilibrium;
    }
  }
  return one;
}

std::string JsonLine(const HealthyBatch& one) { return nlohmann::json(one).dump(); }

std::vector<HealthyBatch> ReadHealthyBatchs(const std::filesystem::path& file) {
  std::vector<HealthyBatch> cases;
  for (const std::string& line : batch::WholeLines(file))
    cases.push_back(nlohmann::json::parse(line).get<HealthyBatch>());
  return cases;
}

}  // namespace flextip::bench
