// A recording's stream over time, as figures.
#pragma once

#include <filesystem>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Returns a figure for each quantity of FOLDER/data.csv, thinned as it is read. Throws InputError
/// where the file cannot be read.
std::vector<Figure> StreamFigures(const std::filesystem::path& folder);

}  // namespace flextip::report
