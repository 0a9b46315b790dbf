// What a scenario's runs may ask for.
#include "simulation/closed_loop/scenario_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "tests/scratch_folder.h"

namespace flextip::simulation {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Returns why the runs are refused: 4000 s along 0.4 m, with that wrist, a tip and updates at 30
/// Hz each. Empty where they may run.
std::string Complaint(double wrist_rate_hz, const std::string& controllers) {
  const auto file = flextip::test_support::ScratchFolder() / "scenario.yaml";
  std::ofstream(file) << fmt::format(R"(
instrument: {{length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}}
port: {{position_m: [0.0, 0.0, 0.17]}}
wrist: {{start_m: [-0.2457, 0.0, 0.3421], max_speed_m_s: 0.3}}
sensors:
  wrist: {{rate_hz: {}, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}}
  tip: {{across_noise_m: 0.0001, depth_noise_m: 0.0006, direction_noise_rad: 0.003, rate_hz: 30}}
path:
  speed_m_s: 0.0001
  waypoints: [{{to_m: [0.0, 0.4, 0.0]}}]
control: {{rate_hz: 30}}
controllers: {}
)",
                                     wrist_rate_hz, controllers);
  const Scenario scenario = ReadScenario(file);
  try {
    RequireShort(scenario, file);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.string()));
    return error.what();
  }
  return "";
}

// 4000 s at 1250 samples a second are five million.
TEST(ScenarioRun, TakesFiveMillionSamplesAtMost) {
  EXPECT_EQ(Complaint(1185.0, "rod-track"), "");  // 4.98 million
  EXPECT_THAT(Complaint(1200.0, "rod-track"),
              AllOf(HasSubstr("4e+03 s"), HasSubstr("1.26e+03 samples a second"),
                    HasSubstr("expected at most 5e+06")));
}

TEST(ScenarioRun, CountsTheSamplesOfAllControllers) {
  EXPECT_EQ(Complaint(560.0, "[rod-track, rod-calculate]"), "");  // 4.96 million
  EXPECT_THAT(Complaint(570.0, "[rod-track, rod-calculate]"), HasSubstr("2 controllers"));
}

}  // namespace
}  // namespace flextip::simulation
