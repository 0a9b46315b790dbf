// The head of the page of flextip control.
#pragma once

#include <filesystem>

#include "report/verdict.h"

namespace flextip::report::leads {

/// Returns the head of a run, or of a measurement of its times alone, by its summary.json. The
/// command has placeholders for its paths.
Head ControlLead(const std::filesystem::path& folder);

}  // namespace flextip::report::leads
