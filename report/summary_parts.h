// The parts of a page that come from summary.json.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "report/report.h"
#include "report/verdict.h"

namespace flextip::report {

/// Begins a page with `title`; below it the command and the version.
Report TitledPage(const std::filesystem::path& folder, const std::string& title);

/// Begins a page as most commands have it: the result in a sentence, numbers, warnings, and a table
/// for each list or map of alike things (controllers, views, ...). `after_head` adds what comes
/// right after the sentence; empty: nothing.
Report BeginPage(const std::filesystem::path& folder, const std::string& title,
                 const std::function<void(Report&)>& after_head = {});

/// Returns the head of a page: the summary's verdict, or the lead of a command that has none.
Head HeadOf(const std::filesystem::path& folder);
/// Returns the summary's warnings but for those that its verdict says.
std::vector<std::string> WarningsNotSaid(const std::filesystem::path& folder);

/// Adds what the check of the input found (the summary's `findings`), each with the line that mends
/// it; nothing where it found nothing, and for a check itself.
void AddFindings(Report& report, const std::filesystem::path& folder);

/// Adds every number of summary.json in large, the most important first.
void AddSummaryNumbers(Report& report, const std::filesystem::path& folder);
/// Adds a table for each list or map of alike things in summary.json.
void AddSummaryTables(Report& report, const std::filesystem::path& folder);

/// Returns summary.json's `command`. Throws InputError where the file cannot be read as a summary.
std::string CommandOf(const std::filesystem::path& folder);

}  // namespace flextip::report
