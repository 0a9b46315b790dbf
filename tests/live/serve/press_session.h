// A session on the robot of press.yaml, by any protocol: 2 mm down into the tissue and back.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/apps/run_program.h"
#include "tests/live/serve/served_program.h"

namespace flextip {

inline const std::string kPressScenario =
    std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml";

/// Returns the session's text. `device` gives the address of a device of the served robot, as in
/// "udp: {port: 5000, device: em0}".
std::string PressSession(const std::function<std::string(const char*)>& device,
                         const std::string& kind, int rate_hz, bool lockstep);

/// Steers the robot by the session; expects that the path is done, that the robot ends paused and
/// that the recording, `folder`/run, replays bit for bit into `folder`/again.
void ExpectPathDone(ServedProgram& robot, const std::string& session, const TestFolder& folder);

/// Returns what a recording's cycles were given and what they gave, without the times of this
/// machine: a line a cycle.
std::string CyclesOf(const std::filesystem::path& recording);

/// Every kind of controller, for test suites.
inline auto EveryKind() {
  return testing::Values("straight-calculate", "straight-track", "flex-calculate", "flex-track",
                         "rod-calculate", "rod-track");
}
std::string NameOfKind(const testing::TestParamInfo<const char*>& kind);

}  // namespace flextip
