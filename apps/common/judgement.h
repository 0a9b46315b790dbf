// How a command tells its judgement: in summary.json, on the terminal, by its exit code.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/judgement.h"

namespace flextip {

/// Returns {grade, says, reasons, next, command}, the head of a page.
nlohmann::json JudgementJson(const Judgement& judged);

/// Prints the answer and the next step, and reasons to be careful on stderr as "beware: ...".
/// Prints nothing where `quiet`.
void PrintJudgement(const Judgement& judged, bool quiet);

/// Throws WorkError, which names the results in `out`, where there is no answer that holds.
void RequireFound(const Judgement& judged, const std::filesystem::path& out);

}  // namespace flextip
