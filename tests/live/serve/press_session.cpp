#include "tests/live/serve/press_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace flextip {
namespace {

using testing::HasSubstr;

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

bool IsTimeOfThisMachine(const std::string& column) {
  return column == "due [ns]" || column == "woke [ns]" || column == "sent [ns]" ||
         column.find("arrived [ns]") != std::string::npos;
}

}  // namespace

std::string PressSession(const std::function<std::string(const char*)>& device,
                         const std::string& kind, int rate_hz, bool lockstep) {
  return fmt::format(
      R"(format: flextip-session
version: 1
instrument: {{length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}}
port: {{position_m: [0.0, 0.0, 0.17]}}
gravity_m_s2: [0.0, 0.0, -9.81]
sources:
  wrist0: {{{0}, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}}
  em0: {{{1}, distance_from_tip_m: 0.02, position_noise_m: 0.00013, orientation_noise_rad: 0.00056}}
  strain0: {{{2}, stations_from_wrist_m: [0.15, 0.5], moment_noise_Nm: 0.0008}}
  vision0: {{{3}}}
robot:
  command: {{{4}}}
  state: {{{5}}}
  command_state: {{{6}}}
{7}controller: {{kind: {8}, rate_hz: {9}}}
limits: {{max_step_m: 0.02, max_speed_m_s: 0.1, max_acceleration_m_s2: 10}}
path: {{frame: start, average_s: 0.3, speed_m_s: 0.01, settle_s: 0.2,
       waypoints: [{{to_m: [0, 0, -0.002]}}, {{to_m: [0, 0, 0]}}]}}
)",
      device("PSM1/measured_cp"), device("em0"), device("strain0"), device("vision0"),
      device("PSM1/servo_cp"), device("PSM1/operating_state"), device("PSM1/state_command"),
      lockstep ? fmt::format("  lockstep: {{{}}}\n", device("lockstep")) : "", kind, rate_hz);
}

void ExpectPathDone(ServedProgram& robot, const std::string& session, const TestFolder& folder) {
  const auto path = [&](const char* name) { return (folder / name).string(); };
  const ProgramResult run =
      RunProgram({"control", session, "-o", path("run"), "--duration", "120"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the path is done"));
  EXPECT_THAT(run.out, HasSubstr("the robot is not enabled"));
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_THAT(robot.out(), HasSubstr("PAUSED homed"));
  const ProgramResult again = RunProgram({"replay", path("run"), "-o", path("again")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

std::string CyclesOf(const std::filesystem::path& recording) {
  std::istringstream text(ReadText(recording / "session0/cycles.csv"));
  std::string line, kept;
  std::vector<bool> leaves_out;
  while (std::getline(text, line)) {
    const std::vector<std::string> fields = Split(line);
    if (leaves_out.empty())
      for (const std::string& field : fields) leaves_out.push_back(IsTimeOfThisMachine(field));
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (i >= leaves_out.size() || !leaves_out[i]) kept += fields[i] + ",";
    kept += "\n";
  }
  return kept;
}

std::string NameOfKind(const testing::TestParamInfo<const char*>& kind) {
  std::string name = kind.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace flextip
