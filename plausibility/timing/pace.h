// Rates that are not as stated, and gaps.
#pragma once

#include <vector>

#include "plausibility/timing/rows.h"

namespace flextip::plausibility {

/// Finds rates that differ from the stated one by more than 15 %.
std::vector<Finding> CheckRates(const std::vector<Rows>& rows);

/// Finds gaps of one stream while another goes on: 10 of its steps, at least 0.4 s. Where all
/// pause, the recording was paused.
std::vector<Finding> CheckGaps(const std::vector<Rows>& rows);

}  // namespace flextip::plausibility
