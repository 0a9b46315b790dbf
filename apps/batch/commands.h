// The commands that a batch can run.
#pragma once

#include <string>
#include <vector>

namespace flextip {

/// Takes the command off the front of `words` ("diagnose"; "calibrate", "tip"). Throws InputError
/// where it is none of those that can be run on many inputs.
std::vector<std::string> TakeBatchCommand(std::vector<std::string>& words);

/// Throws InputError at `file`, `line` for options of a command that belong to the batch: -o,
/// --resume, --force, --quiet.
void RefuseBatchOptions(const std::vector<std::string>& options, const std::string& file,
                        long line);

}  // namespace flextip
