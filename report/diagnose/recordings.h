// Several recordings in one diagnosis: which effect is in which, and what began.
#pragma once

#include <filesystem>

#include "report/report.h"

namespace flextip::report {

/// Adds a table of effects by recording, and one of what began, from diagnosis.json; nothing where
/// it is of one recording.
void AddRecordings(Report& report, const std::filesystem::path& folder);

}  // namespace flextip::report
