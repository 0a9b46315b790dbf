// Hazards by fault and kind of supervision, as a picture.
#pragma once

#include <string>
#include <vector>

#include "bench/fault_campaign/summary.h"

namespace flextip::bench {

/// Returns an SVG: a row a fault, a bar a kind, hazards per 1000 runs.
std::string HazardSvg(const std::vector<KindFigures>& figures);

}  // namespace flextip::bench
