#include "bench/fault_campaign/base.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "simulation/closed_loop/scenario.h"
#include "simulation/plant/plant.h"

namespace flextip::bench {
namespace {

using simulation::LoopSetup;

constexpr double kFloorBeyond_m = 0.001;
constexpr int kLinks = 30;  // on each side of the port: 0.1 mm of the tip
constexpr double kRate_hz = 30.0;

simulation::Scenario Read(Move move) {
  constexpr std::array files{"press",         "chapter4_up",     "chapter4_down",
                             "chapter4_away", "chapter4_toward", "press"};
  return simulation::ReadScenario(std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata" /
                                  "scenarios" /
                                  fmt::format("{}.yaml", files[static_cast<std::size_t>(move)]));
}

/// As the press has them, at the controller's rate.
void SetSensors(Suite suite, simulation::SensorSetup& sensors) {
  static const simulation::SensorSetup press = Read(Move::kPress).loop.sensors;
  const Eigen::Vector3d line_of_sight = press.tip->line_of_sight;
  sensors = press;
  sensors.tip->line_of_sight = line_of_sight;
  sensors.load.emplace();
  sensors.load->comment = "load cell on the tip";
  sensors.load->force_noise_N = 0.02;
  sensors.wrist->rate_hz = sensors.em0->rate_hz = sensors.strain->rate_hz = kRate_hz;
  sensors.load->rate_hz = sensors.tip->rate_hz = kRate_hz;
  if (suite == Suite::kVision) sensors.em0.reset();
  if (suite == Suite::kAll) return;
  sensors.strain.reset();
  sensors.load.reset();
}

void SetPath(Move move, PathSetup& path) {
  path.mode = PathMode::kContinuous;
  path.speed_m_s = 0.015;
  path.settle_s = 0.5;
  if (move == Move::kPress) return;
  if (move == Move::kFree) {
    path.speed_m_s = 0.03;
    path.waypoints_m = {{0.0, 0.0, -0.010}, {0.015, 0.01, -0.010}, {0.015, 0.01, 0.01}, {0, 0, 0}};
  } else {
    path.waypoints_m.emplace_back(Eigen::Vector3d::Zero());  // and back
  }
}

/// A floor across the first leg, beyond its end.
ForbiddenHalfSpace FloorOf(const LoopSetup& setup) {
  simulation::Plant plant(setup.plant, setup.plant_options);
  const Eigen::Vector3d& leg = setup.path.waypoints_m.front();
  const Eigen::Vector3d along = leg.normalized();
  const Eigen::Vector3d p_RE = plant.Solve(setup.p_RW_start).T_RE().p;
  return {p_RE + leg + kFloorBeyond_m * along, -along};
}

}  // namespace

const char* Name(Move move) {
  constexpr std::array names{"press", "up", "down", "away", "toward", "free"};
  return names[static_cast<std::size_t>(move)];
}

const char* Name(Suite suite) {
  constexpr std::array names{"vision", "vision+em", "vision+em+strain+load"};
  return names[static_cast<std::size_t>(suite)];
}

std::string Base::Text() const {
  return fmt::format("{}{}, {}, {}", Name(move), fixture ? " over a floor" : "",
                     flextip::Name(controller), Name(suite));
}

Limits LimitsOf(Move move) {
  Limits limits;
  limits.rates = {.max_step_m = 0.02, .max_speed_m_s = 0.25, .max_acceleration_m_s2 = 10.0};
  const bool hung = move != Move::kPress && move != Move::kFree;
  limits.tip_force_N = hung ? 3.0 : 1.5;
  return limits;
}

LoopSetup SetupOf(const Base& base) {
  static const auto scenarios = [] {
    std::array<simulation::Scenario, kMoves> all;
    for (int i = 0; i < kMoves; ++i) all[static_cast<std::size_t>(i)] = Read(static_cast<Move>(i));
    return all;
  }();
  LoopSetup setup = scenarios[static_cast<std::size_t>(base.move)].loop;
  setup.base.cam0.reset();
  setup.base.tags0.reset();
  setup.seed = base.seed;
  setup.update_rate_hz = kRate_hz;
  setup.controller.kind = base.controller;
  setup.controller.max_step_m = LimitsOf(base.move).rates.max_step_m;
  setup.servo.max_speed_m_s = 0.3;
  setup.plant_options = {kLinks, kLinks};
  if (base.move == Move::kFree) setup.plant.load = {};
  SetSensors(base.suite, setup.sensors);
  SetPath(base.move, setup.path);
  if (base.fixture) setup.fixtures.list.emplace_back(FloorOf(setup));
  return setup;
}

LoopSetup Supervised(LoopSetup setup, Move move, double max_deviation_m, SupervisionKind kind) {
  const Limits limits = LimitsOf(move);
  setup.supervision.kind = kind;
  setup.supervision.rates = limits.rates;
  setup.supervision.rate_hz = setup.update_rate_hz;
  setup.supervision.max_tip_force_N = limits.tip_force_N;
  setup.supervision.max_tip_deviation_m = max_deviation_m;
  return setup;
}

}  // namespace flextip::bench
