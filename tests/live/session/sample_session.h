// A session for tests: the thesis's instrument, all streams of a peer at one port.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "live/session/session.h"
#include "tests/scratch_folder.h"

namespace flextip::live {

inline std::string SessionText() {
  return R"(format: flextip-session
version: 1
instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}
port: {position_m: [0.0, 0.0, 0.17]}
sources:
  wrist0: {openigtlink: {port: 18944, device: PSM1/measured_cp}, position_noise_m: 0.00005,
           orientation_noise_rad: 0.0003}
  strain0: {openigtlink: {port: 18944, device: strain0}, stations_from_wrist_m: [0.15, 0.5],
            moment_noise_Nm: 0.0008}
  vision0: {openigtlink: {port: 18944, device: vision0}}
robot:
  command: {openigtlink: {port: 18944, device: PSM1/servo_cp}}
  state: {openigtlink: {port: 18944, device: PSM1/operating_state}}
  command_state: {openigtlink: {port: 18944, device: PSM1/state_command}}
controller: {kind: rod-track, rate_hz: 100}
limits: {max_step_m: 0.002, max_speed_m_s: 0.05, max_acceleration_m_s2: 1.0}
path: {frame: start, average_s: 0.2, speed_m_s: 0.01, settle_s: 0.5,
       waypoints: [{to_m: [0, 0, -0.01]}]}
)";
}

/// Writes a session file into a folder of this test program.
inline std::filesystem::path WriteSession(const std::string& text) {
  const auto file = flextip::test_support::ScratchFolder() / "session.yaml";
  std::ofstream(file) << text;
  return file;
}

}  // namespace flextip::live
