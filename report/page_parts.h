// Parts that the pages of several commands share: pictures, tables and curves from result files.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {

/// Reads `files` into one row of pictures under a heading; the caption is the file's name.
void AddPictureFiles(Report& report, const std::string& heading,
                     const std::vector<std::filesystem::path>& files);

/// Adds a file of numbers as a table, its first 60 rows; nothing where it is missing.
void AddShortTable(Report& report, const std::filesystem::path& file, const std::string& title);

/// Seconds since the first time stamp of the table's first column (ns).
std::vector<double> SecondsOf(const ResultTable& table);
/// The column times `factor`; empty where the table has no such column.
std::vector<double> Scaled(const ResultTable& table, const std::string& column, double factor);

/// The path of `prefix`_x, _y, _z (m) as a trace in mm; no points where a column is absent.
FigureTrace PathTrace(const ResultTable& table, const std::string& prefix, const std::string& name);

/// Every column of numbers over time, one plot for each group of alike names ("p_RE_x [m]",
/// "p_RE_y [m]", ... become one).
void AddColumnsOverTime(Report& report, const ResultTable& table);

}  // namespace flextip::report
