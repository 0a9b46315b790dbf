// Values that repeat or stand still.
#pragma once

#include <vector>

#include "plausibility/timing/rows.h"

namespace flextip::plausibility {

/// Finds streams in which each value stands several times in a row, and streams that stand still
/// for 0.5 s and more while the instrument moves. Takes their idle rows out of `repaired`.
std::vector<Finding> CheckStuck(const std::vector<Rows>& rows, Recording& repaired);

}  // namespace flextip::plausibility
