// The head of simulate's page.
#pragma once

#include <filesystem>

#include "report/verdict.h"

namespace flextip::report::leads {

/// Returns which controller is best, by how much, and why, from the folder's summary.json. Empty
/// where none has a deviation. Throws InputError where the file cannot be read.
Head SimulateLead(const std::filesystem::path& folder);

}  // namespace flextip::report::leads
