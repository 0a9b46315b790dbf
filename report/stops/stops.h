// The stops of a run on its page: each in a sentence and a picture of four parts. They are read
// from the excerpts in the recording's folder `stops`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/report.h"

namespace flextip::report {

/// Returns the excerpts in `folder`/stops, the gravest first.
std::vector<std::filesystem::path> StopsIn(const std::filesystem::path& folder);

/// Returns the sentence of an excerpt. Throws InputError where its summary is damaged.
std::string StopSays(const std::filesystem::path& excerpt);

/// Returns the four parts of an excerpt's picture, for two columns. `name` begins their names.
/// Throws InputError where its files lack something or are damaged.
std::vector<Figure> StopPicture(const std::filesystem::path& excerpt,
                                const std::string& name = "stop");

/// Adds the gravest stops of a run, `name` before each sentence where it is not empty; nothing for
/// a run without. Throws InputError where stop.csv lacks a column or is damaged.
void AddStops(Report& report, const std::filesystem::path& folder, const std::string& name = "");

}  // namespace flextip::report
