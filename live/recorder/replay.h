// A recorded session run again: its cycles' inputs through the same cycle.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "live/recorder/cycle_record.h"

namespace flextip::live {

struct ReplayedCycle {
  TimeNs t_ns = 0;
  Hold hold = Hold::kNone, hold_again = Hold::kNone;
  bool has_command = false;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero(), p_RW_again = Eigen::Vector3d::Zero();  ///< m, R
  bool equal = false;  ///< every output, bit for bit
};

struct ReplayedSession {
  std::vector<ReplayedCycle> cycles;
  long equal = 0;
  double largest_difference_m = 0.0;  ///< of the commands
  std::vector<std::string> warnings;
};

/// Returns whether the folder is a recorded session.
bool HasSession(const std::filesystem::path& recording);

/// Returns the session that was recorded. Throws InputError.
Session RecordedSession(const std::filesystem::path& recording);

/// Returns the cycle as it was before the recording's first row: a new one, and in an excerpt with
/// the state that the run had there. Throws InputError where the state is damaged or of another
/// kind of session.
std::unique_ptr<Cycle> CycleAtBegin(const std::filesystem::path& recording, const Session& session);

/// Returns whether every output is the same, bit for bit.
bool SameOutputs(const CycleOutputs& a, const CycleOutputs& b);

/// Runs the recorded inputs through the cycle of `session`, which is the recorded one or another.
/// Throws InputError with file and line.
ReplayedSession ReplaySession(const std::filesystem::path& recording, const Session& session);

}  // namespace flextip::live
