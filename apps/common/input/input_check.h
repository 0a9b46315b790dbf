// The check of a recording at the start of a command that works on it (docs/usage/check.md).
#pragma once

#include <CLI/CLI.hpp>
#include <vector>

#include "plausibility/command_use.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip {

/// How a command has its recording checked.
struct InputCheck {
  bool skip = false;    ///< --no-check
  bool quiet = false;   ///< doubts are not printed
  bool silent = false;  ///< nothing is
};

/// Adds --no-check. `skip` must outlive the parsing.
void AddNoCheckOption(CLI::App& command, bool& skip);

/// Pictures of cam0 to look at.
struct PicturesToCheck {
  FrameSource* frames = nullptr;  ///< null: none
  double share = 1.0;             ///< of them, from the first on
};

/// Checks `recording`, calibrations in it, for what the command does with it. Prints what was found
/// on stderr (what is wrong even where `quiet`), and takes streams out of `recording` that are
/// wrong and only help. Returns the findings, those that the command needs first; they go to the
/// summary, the page and the grade of the answer. A finding stops no command: the check can err,
/// too.
std::vector<plausibility::Finding> CheckInput(const InputCheck& check,
                                              const plausibility::CommandUse& use,
                                              Recording& recording,
                                              const PicturesToCheck& pictures = {});

}  // namespace flextip
