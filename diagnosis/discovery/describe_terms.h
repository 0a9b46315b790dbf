// Terms as results: names, words, where they matter, pictures, gain.
#pragma once

#include <vector>

#include "diagnosis/discovery/refit.h"

namespace flextip::diagnosis {

/// The terms as results; with `measure_gain` each one's gain over the model without it.
std::vector<Discovered> DescribeTerms(const TermModel& model, bool measure_gain);

}  // namespace flextip::diagnosis
