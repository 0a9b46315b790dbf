// Findings of a check as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/judgement.h"
#include "plausibility/finding.h"

namespace flextip {

/// Returns "LABEL: text [id]" and, on a second line, the mend where there is one.
std::string FindingText(const std::string& label, const plausibility::Finding& finding);

/// Says once in `judged` that the check of the recording found something doubtful.
void MentionFindings(const std::vector<plausibility::Finding>& findings, Judgement& judged);

/// Returns a list of `finding` (the id), `severity`, `text`, `mend`.
nlohmann::json FindingsJson(const std::vector<plausibility::Finding>& findings);

}  // namespace flextip
