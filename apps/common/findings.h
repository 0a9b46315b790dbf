// Findings of a check as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plausibility/finding.h"

namespace flextip {

/// Returns "LABEL: text [id]" and, on a second line, the mend where there is one.
std::string FindingText(const std::string& label, const plausibility::Finding& finding);

/// Returns a list of `finding` (the id), `severity`, `text`, `mend`.
nlohmann::json FindingsJson(const std::vector<plausibility::Finding>& findings);

}  // namespace flextip
