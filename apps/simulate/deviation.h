// deviation.csv: the true tip beside the desired one, update by update.
#pragma once

#include <filesystem>

#include "simulation/closed_loop/closed_loop.h"

namespace flextip {

/// Throws WorkError where the file cannot be written.
void WriteDeviation(const std::filesystem::path& file, const simulation::LoopResult& result);

}  // namespace flextip
