// The curves of several runs over time, in one figure each.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Returns a figure for each quantity over time that results of `command` have; `names` are the
/// runs' in the legend. Files or columns that are absent are left out.
std::vector<Figure> CurvesOf(const std::string& command,
                             const std::vector<std::filesystem::path>& folders,
                             const std::vector<std::string>& names);

}  // namespace flextip::report
