// The matrix as a picture: SVG, written here.
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis_matrix/output/summary.h"

namespace flextip::bench {

/// Panels one below the other, cells shaded by their share of the row with the count in them; the
/// right answer's cell is framed.
std::string ConfusionSvg(const std::vector<Confusion>& confusions, const std::string& title);

}  // namespace flextip::bench
