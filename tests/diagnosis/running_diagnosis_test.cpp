// The running diagnosis in the closed loop: what sets in is warned of and named, a healthy loop is
// not, and a cycle allocates nothing.
#include "diagnosis/running/running_diagnosis.h"
#include "diagnosis/running/warnings_table.h"

#include <gmock/gmock.h>

#include <bit>
#include <filesystem>

#include "pipeline/sensor_readings.h"
#include "simulation/closed_loop/scenario.h"
#include "tests/control/allocation_counter.h"

namespace flextip::diagnosis {
namespace {

using simulation::LoopResult;
using simulation::LoopSetup;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kOnset_s = 12.0;

/// The press, going on for half a minute, with a load cell and all other sensors; within tolerance.
LoopSetup Press() {
  LoopSetup setup = simulation::ReadScenario(std::filesystem::path(FLEXTIP_SOURCE_DIR) /
                                             "testdata" / "scenarios" / "press.yaml")
                        .loop;
  setup.base.cam0.reset();
  setup.base.tags0.reset();
  setup.plant_options = {40, 40};
  setup.update_rate_hz = 30.0;
  simulation::SensorSetup& sensors = setup.sensors;
  sensors.wrist->rate_hz = sensors.em0->rate_hz = sensors.strain->rate_hz = 30.0;
  sensors.load = LoadStream{"", 30.0, 0.02, {}};
  setup.controller.kind = ControllerKind::kRodTrack;
  setup.plant.effects.port_offset_m = {1e-4, -2e-4, 1e-4};
  setup.plant.effects.stiffness_scale = 1.015;
  setup.sensor_effects.em_offset_m = {-1e-4, 1e-4, 2e-4};
  setup.path.waypoints_m.clear();
  for (int i = 0; i < 20; ++i) {
    setup.path.waypoints_m.emplace_back(0.005, 0.006 * (i % 2), -0.010);
    setup.path.waypoints_m.emplace_back(-0.006, 0.004, -0.004 * (i % 3));
  }
  setup.max_s = 27.0;
  setup.seed = 3;
  setup.watch = [base = setup.base] { return std::make_unique<RunningDiagnosis>(base); };
  return setup;
}

LoopSetup With(const std::function<void(simulation::EffectsOnset&)>& sets_in) {
  LoopSetup setup = Press();
  setup.onset = {kOnset_s, setup.plant.effects, setup.sensor_effects};
  sets_in(*setup.onset);
  return setup;
}

double FoundAt_s(const LoopResult& result) {
  for (const auto& update : result.updates) {
    if (update.cause.IsThere())
      return 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
  }
  return -1.0;
}

void ExpectFound(const LoopResult& result, const std::string& name, double value, double within) {
  const FoundCause& found = result.updates.back().cause;
  ASSERT_TRUE(found.IsThere()) << name;
  EXPECT_EQ(CauseName(found.likeliest.cause), name) << Text(found);
  EXPECT_NEAR(found.likeliest.value, value, within) << Text(found);
  EXPECT_GT(FoundAt_s(result), kOnset_s);
  EXPECT_LT(FoundAt_s(result), kOnset_s + 8.0);
  const double since_s =
      1e-9 * static_cast<double>(found.since_ns - simulation::kSimulationStart_ns);
  EXPECT_NEAR(since_s, kOnset_s, 2.5) << Text(found);
}

TEST(RunningDiagnosis, NamesAPortThatYields) {
  const LoopResult result =
      RunClosedLoop(With([](auto& onset) { onset.plant.port_compliance_m_N = 0.0008; }), nullptr);
  ExpectFound(result, "port_compliance", 0.0008, 0.0002);
  EXPECT_THAT(Text(result.updates.back().cause),
              StartsWith("the port yields more than the model says: 0."));
}

TEST(RunningDiagnosis, NamesAPortThatMoves) {
  const LoopResult result = RunClosedLoop(
      With([](auto& onset) { onset.plant.port_offset_m += Eigen::Vector3d(0.002, 0.001, 0.0); }),
      nullptr);
  ExpectFound(result, "port_offset", 0.0022, 0.0008);
}

TEST(RunningDiagnosis, NamesAnEmSensorThatIsOff) {
  const LoopResult result = RunClosedLoop(
      With([](auto& onset) { onset.sensors.em_offset_m += Eigen::Vector3d(0.0, 0.0015, 0.0); }),
      nullptr);
  ExpectFound(result, "em_offset", 0.0015, 0.0005);
}

TEST(RunningDiagnosis, NamesASensorThatDriftsSlowly) {
  LoopSetup setup = Press();
  // 0.1 mm/s: the vote holds it against a limit of 0.25 mm, and learns what stays.
  setup.faults.push_back(
      {simulation::FaultKind::kDrift, simulation::FaultStream::kEm0, kOnset_s, 60.0, 0.0001});
  const LoopResult result = RunClosedLoop(setup, nullptr);
  ExpectFound(result, "em_drift", 0.0001, 0.00004);
}

TEST(RunningDiagnosis, SaysUnknownWhereNoLinearSizeExplains) {
  const LoopResult result = RunClosedLoop(
      With([](auto& onset) { onset.sensors.em_offset_m += Eigen::Vector3d(0.0, 0.1, 0.0); }),
      nullptr);
  const FoundCause& found = result.updates.back().cause;
  ASSERT_TRUE(found.IsThere());
  EXPECT_EQ(CauseName(found.likeliest.cause), "unknown") << Text(found);
  EXPECT_EQ(Text(found), "the sensors differ as no cause of the list explains [unknown]");
}

TEST(RunningDiagnosis, SaysNothingOfAHealthyLoopAtRest) {
  LoopSetup setup = Press();
  setup.path.waypoints_m.resize(1);
  setup.path.settle_s = 200.0;
  setup.max_s = 120.0;
  const LoopResult result = RunClosedLoop(setup, nullptr);
  EXPECT_GT(result.updates.size(), 3000U);
  EXPECT_EQ(FoundAt_s(result), -1.0) << Text(result.updates.back().cause);
}

TEST(RunningDiagnosis, SaysNothingOfAHealthyLoop) {
  const LoopResult result = RunClosedLoop(Press(), nullptr);
  EXPECT_GT(result.updates.size(), 700U);
  EXPECT_EQ(FoundAt_s(result), -1.0) << Text(result.updates.back().cause);
}

/// A run's sensors, cycle by cycle.
std::vector<Measurements> SensorsOf(const LoopResult& result) {
  std::vector<Measurements> all;
  for (const auto& update : result.updates)
    all.push_back(*MeasurementsAt(result.recording, update.t_ns));
  return all;
}

struct Watched {
  FoundCause found;
  long samples = 0;
};
Watched Watch(const LoopResult& result, const std::vector<Measurements>& sensors) {
  const LoopSetup setup = Press();
  RunningDiagnosis watch(setup.base);
  const ShaftChange none;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const TimeNs t_ns = result.updates[i].t_ns;
    watch.Look({t_ns, sensors[i], {t_ns, t_ns, t_ns, t_ns}, none});
    watch.Work();
  }
  return {watch.Found(), watch.Samples()};
}

TEST(RunningDiagnosis, LeavesASingleWildReadingOut) {
  const LoopResult result = RunClosedLoop(Press(), nullptr);
  std::vector<Measurements> sensors = SensorsOf(result);
  const Watched before = Watch(result, sensors);
  for (const std::size_t i : {300U, 450U, 600U}) sensors[i].em->T_RS.p.x() += 0.02;
  const Watched after = Watch(result, sensors);
  EXPECT_FALSE(before.found.IsThere());
  EXPECT_FALSE(after.found.IsThere()) << Text(after.found);
  EXPECT_GE(before.samples - after.samples, 2);  // every second one is looked at
  EXPECT_LE(before.samples - after.samples, 9);
}

TEST(RunningDiagnosis, SaysTheSameOfTheSameSensors) {
  const LoopResult result =
      RunClosedLoop(With([](auto& onset) { onset.plant.port_compliance_m_N = 0.0008; }), nullptr);
  const std::vector<Measurements> sensors = SensorsOf(result);
  const FoundCause once = Watch(result, sensors).found, again = Watch(result, sensors).found;
  EXPECT_TRUE(once.IsThere());
  EXPECT_EQ(once.likeliest.cause, again.likeliest.cause);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(once.likeliest.value),
            std::bit_cast<std::uint64_t>(again.likeliest.value));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(once.log_evidence),
            std::bit_cast<std::uint64_t>(again.log_evidence));
}

TEST(RunningDiagnosis, AllocatesNothingOnceItIsMade) {
  const LoopResult result =
      RunClosedLoop(With([](auto& onset) { onset.plant.port_compliance_m_N = 0.0008; }), nullptr);
  const std::vector<Measurements> sensors = SensorsOf(result);
  RunningDiagnosis watch(Press().base);
  const ShaftChange none;
  const long before = AllocationCount();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const TimeNs t_ns = result.updates[i].t_ns;
    watch.Look({t_ns, sensors[i], {t_ns, t_ns, t_ns, t_ns}, none});
    watch.Work();
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_TRUE(watch.Found().IsThere());
}

TEST(WarningsCsv, HasARowForEachWarning) {
  EXPECT_EQ(WarningsCsv({}),
            "#timestamp [ns],cause [],value [SI],sd [SI],or [],or_value [SI],or_sd [SI],or_others "
            "[],since [ns],log_evidence [],text []\n");
  Warning warning;
  warning.t_ns = 7;
  warning.cause.likeliest = {0, 0.5, 0.25};
  warning.cause.since_ns = 3;
  warning.cause.log_evidence = 12.5;
  const std::string text = WarningsCsv(std::vector{warning});
  EXPECT_THAT(text, HasSubstr("\n7,port_compliance,0.5,0.25,,,,0,3,12.5,"));
  EXPECT_THAT(text, HasSubstr("the port yields more than the model says: 500 mm/N (sd 250)"));
}

TEST(CauseText, HasUnitsAndBothNames) {
  FoundCause found;
  EXPECT_EQ(Text(found), "");
  found.likeliest = {0, 0.0008, 0.0001};
  EXPECT_EQ(Text(found),
            "the port yields more than the model says: 0.80 mm/N (sd 0.10) [port_compliance]");
  found.other = {1, 0.0019, 0.0003};
  found.has_more = true;
  EXPECT_EQ(Text(found),
            "the port yields more than the model says: 0.80 mm/N (sd 0.10), or the port is not "
            "where it was: 1.90 mm (sd 0.30), or others [port_compliance or port_offset]");
}

}  // namespace
}  // namespace flextip::diagnosis
