#include "apps/simulate/arm.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/common/output.h"
#include "recording/recording_writer.h"
#include "report/pages.h"
#include "simulation/joints/arm_scenario.h"

namespace flextip {

void SimulateArm(const ArmCommand& command, bool quiet) {
  ReadLog log;
  const simulation::ArmScenario scenario = simulation::ReadArmScenario(command.scenario, log);
  OutputFolder output(command.out, "simulate",
                      {.force = command.force, .inputs = {command.scenario}});
  output.Warn(log.warnings);
  const Recording recording =
      simulation::RecordArm(scenario.arm, scenario.faults, scenario.sensors, scenario.motion);
  WriteRecording(output.folder(), recording);
  output.WriteSummary({{"scenario", command.scenario.filename().string()},
                       {"joints", scenario.arm.Size()},
                       {"seconds_of_motion", scenario.motion.seconds}});
  report::WriteArmMotionReport(output.folder());
  output.Commit();
  if (quiet) return;
  fmt::print("{} joints, {:g} s\n", scenario.arm.Size(), scenario.motion.seconds);
  fmt::print("{}\n", (command.out / "report.html").string());
  fmt::print("next: flextip diagnose {0} -o {0}-diagnosis\n", command.out.string());
}

}  // namespace flextip
