// The head of a page: the answer, how good it is and why, the next step.
#pragma once

#include <filesystem>
#include <string>

namespace flextip::report {

/// Returns the head by FOLDER/summary.json's `verdict`: {grade, says, reasons, next, command}.
/// Empty where the summary has none. Throws InputError where the file cannot be read.
std::string VerdictHtml(const std::filesystem::path& folder);

}  // namespace flextip::report
