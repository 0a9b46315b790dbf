// The chain's error budget beside the errors themselves, as a picture: SVG, written here.
#pragma once

#include <string>
#include <vector>

namespace flextip::bench {

/// In mm: the standard deviation claimed, the RMS error, and what of that is the same in every
/// repetition.
struct ClaimedAndMeasured {
  double claimed = 0, measured = 0, constant = 0;
  double Ratio() const { return measured / claimed; }
};

struct ChainPart {
  std::string name;
  ClaimedAndMeasured depth_mm = {}, across_mm = {};
  double depth_ratio_sd = 0;
};

/// A pair of bars for each part, along the line of sight and across.
std::string ChainSvg(const std::vector<ChainPart>& parts);

}  // namespace flextip::bench
