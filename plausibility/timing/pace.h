// Rates that are not as stated, and gaps.
#pragma once

#include <vector>

#include "plausibility/timing/rows.h"

namespace flextip::plausibility {

/// Finds rates that differ from the stated one by more than 15 %, by the usual step and by the
/// mean.
std::vector<Finding> CheckRates(const std::vector<Rows>& rows);

/// Finds gaps of one stream while another goes on: 5 of its steps, and at least 0.4 s or a
/// twentieth of a short recording. Where all pause, the recording was paused.
std::vector<Finding> CheckGaps(const std::vector<Rows>& rows);

}  // namespace flextip::plausibility
