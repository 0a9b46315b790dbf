// The warnings of a run as a table: warnings.csv (docs/formats.md).
#pragma once

#include <span>
#include <string>

#include "estimation/watch/instrument_watch.h"

namespace flextip::diagnosis {

/// Returns the table: a row each time that other causes were named. Sizes in SI units.
std::string WarningsCsv(std::span<const Warning> warnings);

}  // namespace flextip::diagnosis
