// The end of a page: how its results were made.
#pragma once

#include <filesystem>
#include <string>

namespace flextip::report {

/// Returns, from FOLDER/summary.json, the command as typed, the inputs, the version, date and
/// duration. Lines that the summary lacks are left out. Throws InputError where the file cannot be
/// read.
std::string PageEnd(const std::filesystem::path& folder);

}  // namespace flextip::report
