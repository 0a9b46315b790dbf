// The head of simulate's page.
#pragma once

#include <nlohmann/json.hpp>

#include "report/verdict.h"

namespace flextip::report::leads {

/// Returns which controller is best, by how much, and why. Empty where none has a deviation.
Head SimulateLead(const nlohmann::ordered_json& summary);

}  // namespace flextip::report::leads
