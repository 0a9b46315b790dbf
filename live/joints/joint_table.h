// session0/joint_cycles.csv: every cycle at an arm's joints, with every number exact, and the same
// cycles again.
#pragma once

#include <deque>
#include <filesystem>
#include <string>

#include "live/joints/joint_loop.h"
#include "recording/read_log.h"

namespace flextip::live {

/// Returns the table's text.
std::string JointCyclesCsv(const std::deque<JointRecord>& cycles, int joints);

/// Reads a table of so many joints. Throws InputError with file and line.
std::deque<JointRecord> ReadJointCycles(const std::filesystem::path& file, int joints,
                                        ReadLog& log);

/// Gives the recorded inputs to a new cycle, and returns how many outputs differ in any bit.
long CyclesThatDiffer(const std::deque<JointRecord>& cycles, JointCycle cycle);

}  // namespace flextip::live
