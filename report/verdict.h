// The head of a page: the answer, how good it is and why, the next step.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flextip::report {

/// Returns the head for summary.json's `verdict`: {grade, says, reasons, next, command}.
std::string VerdictHtml(const nlohmann::ordered_json& verdict);

}  // namespace flextip::report
