// How the numbers of many results spread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// Returns the columns of numbers in which rows of a batch's table.csv differ, the most important
/// of `command` first; times last.
std::vector<std::string> SpreadColumns(const std::filesystem::path& table,
                                       const std::string& command);

/// Returns a figure for each of the first of these columns: every item a point, from the smallest
/// to the largest. Throws InputError where the table cannot be read.
std::vector<Figure> SpreadOf(const std::filesystem::path& table, const std::string& command);

}  // namespace flextip::report
