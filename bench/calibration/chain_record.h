// A repetition of the chain as a line of JSON.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "bench/calibration/chain_commands.h"

namespace flextip::bench {

std::string JsonLine(unsigned seed, const ChainRun& run);

/// Returns the repetitions of a file by their seeds, none where it is missing. A last line that was
/// cut off is left out. Throws InputError, with the line, for any other that is none.
std::map<unsigned, ChainRun> ReadChainRuns(const std::filesystem::path& file);

}  // namespace flextip::bench
