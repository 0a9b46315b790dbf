// What a diagnosis found that has no name: sentences, a picture and a table.
#pragma once

#include <filesystem>

#include "report/diagnose/result.h"
#include "report/report.h"

namespace flextip::report {

/// Adds a part for the terms of `result`, with pictures of FOLDER/discovered.csv where it is there;
/// nothing where there are none.
void AddDiscovered(Report& report, const std::filesystem::path& folder,
                   const DiagnosedResult& result);

}  // namespace flextip::report
