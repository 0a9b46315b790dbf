// The next step of a result whose page has its head from the summary (report/leads).
#pragma once

#include <filesystem>

namespace flextip {

/// Prints the next step of the results in `folder`, as their page says it; nothing where it says
/// none.
void PrintNextOf(const std::filesystem::path& folder);

}  // namespace flextip
