// How a command tells its judgement: in summary.json, on the terminal, by its exit code.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/common/command_paths.h"
#include "core/judgement.h"

namespace flextip {

/// Returns {grade, says, reasons, next, command}, the head of a page.
nlohmann::json JudgementJson(const Judgement& judged);

/// Prints the answer and the next step with its command, `paths` in it, and reasons to be careful
/// on stderr as "beware: ...". Prints nothing where `quiet`.
void PrintJudgement(const Judgement& judged, const CommandPaths& paths, bool quiet);

/// Prints the next step alone, of a page whose head is made by report/leads.
void PrintNext(const std::string& next, const std::string& command);

/// Throws WorkError, which names the folder of the results, where there is no answer that holds.
void RequireFound(const Judgement& judged, const CommandPaths& paths);

}  // namespace flextip
