// The head of a page by summary.json, for commands that have no judgement of a library.
#pragma once

#include <filesystem>

#include "report/verdict.h"

namespace flextip::report::leads {

/// Returns the head of a result folder: the result in a sentence, its grade, the next step. The
/// command has the paths of the summary's `output` and `inputs`, and is empty where the summary
/// states none. All empty where the files do not tell. Throws InputError where a file cannot be
/// read.
Head LeadOf(const std::filesystem::path& folder);

}  // namespace flextip::report::leads
