// Time stamps that are no nanoseconds.
#pragma once

#include <vector>

#include "plausibility/timing/rows.h"

namespace flextip::plausibility {

/// Finds streams whose time stamps are in another unit, by the rate they state (by the duration of
/// the other streams where they state none). Undoes the unit in `repaired`.
std::vector<Finding> CheckTimeUnits(const std::vector<Rows>& rows, Recording& repaired);

}  // namespace flextip::plausibility
