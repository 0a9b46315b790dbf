// What the pages of several commands have in common.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {

/// A page with the head that every command's page has: what was run, the figures of summary.json,
/// its warnings, and a table for each list or map of alike things in it (controllers, views, ...).
Report BeginPage(const std::filesystem::path& folder, const std::string& title);

/// Its parts. Only the title and what was run; `title` makes the title of the command.
Report TitledPage(const std::filesystem::path& folder,
                  const std::function<std::string(const std::string& command)>& title);
/// Every number of summary.json as a large figure.
void AddSummaryFigures(Report& report, const std::filesystem::path& folder);
/// A table for each list or map of alike things in summary.json.
void AddSummaryTables(Report& report, const std::filesystem::path& folder);

/// Reads `files` into one row of pictures under a heading; the caption is the file's name.
void AddPictureFiles(Report& report, const std::string& heading,
                     const std::vector<std::filesystem::path>& files);

/// Every figure of a figures.json.
void AddFigureFile(Report& report, const std::filesystem::path& file);

/// Seconds since the first time stamp of the table's first column (ns).
std::vector<double> SecondsOf(const ResultTable& table);
/// The column times `factor`; empty where the table has no such column.
std::vector<double> Scaled(const ResultTable& table, const std::string& column, double factor);

/// The path of `prefix`_x, _y, _z (m) as a trace in mm; no points where a column is absent.
PlotTrace PathTrace(const ResultTable& table, const std::string& prefix, const std::string& name);

/// Every column of numbers over time, one plot for each group of alike names ("p_RE_x [m]",
/// "p_RE_y [m]", ... become one).
void AddColumnsOverTime(Report& report, const ResultTable& table);

}  // namespace flextip::report
