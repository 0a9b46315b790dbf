// Lines of cases.jsonl, and the table made of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/several_recordings/run.h"

namespace flextip::bench {

std::string SeveralLine(const SeveralRecord& record);
/// None where the file is missing; a last line that was cut off is left out.
std::vector<SeveralRecord> ReadSeveral(const std::filesystem::path& file);
std::string SeveralTable(const std::vector<SeveralRecord>& records);

}  // namespace flextip::bench
