// Which findings matter to a command, by what it does with the parts of a recording.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Subjects ("em0", "port", "instrument") or whole ids of findings ("cam0.identity").
using Subjects = std::set<std::string>;

struct CommandUse {
  std::string command;    ///< "track"
  Subjects needs;         ///< the command's answer is wrong where these are
  Subjects helped_by;     ///< streams that the command does without where they are wrong
  Subjects unknown = {};  ///< what the command is to find (CheckOptions::unknown)
};

/// The findings of a check, sorted for a command.
struct FindingsForUse {
  std::vector<Finding> needed;  ///< wrong, of what the command needs
  /// Doubtful, or wrong of something that the command does without: doubtful here, and said so.
  std::vector<Finding> beware;
  Subjects left_out;  ///< streams of `helped_by` that are wrong
};

/// Sorts the findings. Doubts of what the command does not use are dropped.
FindingsForUse SortForUse(const std::vector<Finding>& findings, const CommandUse& use);

/// Takes streams out of a recording: em0, em1, strain0, load0, command0 or vision0.
void LeaveOut(const Subjects& streams, Recording& recording);

}  // namespace flextip::plausibility
