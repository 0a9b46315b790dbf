// The head of the diagnosis page, and the numbers and warnings below it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/diagnose/result.h"
#include "report/diagnose/words.h"
#include "report/report.h"
#include "report/verdict.h"

namespace flextip::report {

/// The grade of a diagnosis that no model comes near.
inline constexpr const char* kNoAnswer = "not found";

/// Returns the summary's verdict with its answer in the units people read; where the grade is
/// kNoAnswer, as it is.
Head HeadOfDiagnosis(const std::filesystem::path& folder, const DiagnosedResult& result,
                     const Headline& headline);
/// Adds the numbers that count: probability, errors before and after.
void AddGainFigures(Report& report, const DiagnosedResult& result);
/// Adds the warnings of both files but for those in `said`, each once.
void AddWarningsNotSaid(Report& report, const DiagnosedResult& result, const RunSummary& summary,
                        const std::vector<std::string>& said);

}  // namespace flextip::report
