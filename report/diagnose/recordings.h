// Several recordings in one diagnosis: which effect is in which, and what began.
#pragma once

#include <filesystem>
#include <string>

#include "report/report.h"

namespace flextip::report {

/// Adds a table of effects by recording, and one of what began, from diagnosis.json; nothing where
/// it is of one recording.
void AddRecordings(Report& report, const std::filesystem::path& folder);

/// Adds a table of the motions of `simulate --diagnose` and what was known after each, from
/// summary.json; nothing where there are no rounds.
void AddRounds(Report& report, const std::filesystem::path& folder);

/// Returns "stiffness began in C (> 99 %). Before that: ", to stand before the answer for what all
/// have in common; empty where nothing began.
std::string WhatBegan(const std::filesystem::path& folder);

}  // namespace flextip::report
