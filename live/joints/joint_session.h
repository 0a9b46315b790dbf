// A session that moves an arm by its joints: which robot, along which path, by which model
// (docs/usage/arms.md).
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "live/protocols/protocol.h"

namespace flextip::live {

struct JointSession {
  std::filesystem::path file;
  std::filesystem::path desired;  ///< recording whose joints_command0 are the desired joints
  std::filesystem::path model;    ///< of the arm; empty: none
  Address measured, command, state;
  std::optional<Address> command_state;
  double rate_hz = 500.0;
  double stale_s = 0.05;
  /// One number a joint; empty: the usual ones.
  std::vector<double> follow_limit, approach_rate, max_rate, max_correction;
};

/// Whether a session file is of joints. Throws InputError where it cannot be read.
bool IsJointSession(const std::filesystem::path& file);

/// Throws InputError with file and line for keys that are missing, unknown or of the wrong kind,
/// and for a protocol that carries no joints. Files are named relative to the session's folder.
JointSession ReadJointSession(const std::filesystem::path& file);

}  // namespace flextip::live
