#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

/// Returns whether a tag faces away from the shaft, as a side of a prism around it.
bool IsAround(const CollarTag& tag) {
  const Eigen::Vector3d outward = -tag.T_EG.R.col(2);
  const Eigen::Vector2d across = tag.T_EG.p.tail<2>();
  return outward.tail<2>().dot(across) > 0.9 * across.norm();
}

/// Tags at one place along the shaft are sides of a prism around it.
void CheckRing(const std::vector<const CollarTag*>& ring, std::vector<Finding>& findings) {
  constexpr std::size_t kFewest = 3;
  constexpr double kTolerance = 1.05;
  if (ring.size() < kFewest) return;
  double radius = 0.0, size = 0.0;
  for (const CollarTag* tag : ring) {
    radius = std::max(radius, tag->T_EG.p.tail<2>().norm());
    size = std::max(size, tag->size_m);
  }
  const double sides = static_cast<double>(ring.size());
  const double room = 2.0 * radius * std::tan(std::numbers::pi / sides);
  if (size <= kTolerance * room) return;
  findings.push_back(
      {Severity::kWrong, "tags0.size",
       fmt::format("tags0: {} tags of {:.3g} mm do not fit around the collar: a radius of {:.3g} "
                   "mm leaves {:.3g} mm for each",
                   ring.size(), 1e3 * size, 1e3 * radius, 1e3 * room),
       "size_m, the black border's outer edge, and T_EG in tags0/sensor.yaml"});
}

}  // namespace

void CheckCollar(Recording& recording, std::vector<Finding>& findings) {
  constexpr double kLargest_m = 0.06;
  const auto& tags = recording.tags0->tags;
  double largest = 0.0;
  for (const CollarTag& tag : tags) largest = std::max(largest, tag.size_m);
  if (largest > kLargest_m) {
    const bool mm = largest > 0.9;
    findings.push_back(
        {Severity::kWrong, "tags0.unit",
         fmt::format("tags0: a tag of {:.4g} m looks like {}: none so large fits an instrument",
                     largest, mm ? "millimetres" : "centimetres"),
         fmt::format("size_m: {:.4g} in tags0/sensor.yaml", (mm ? 1e-3 : 1e-2) * largest)});
    recording.tags0.reset();
    return;
  }
  std::map<long, std::vector<const CollarTag*>> rings;  // by mm along the shaft
  for (const CollarTag& tag : tags)
    if (IsAround(tag)) rings[std::lround(tag.T_EG.p.x() * 1e3)].push_back(&tag);
  for (const auto& [along_mm, ring] : rings) CheckRing(ring, findings);
}

}  // namespace flextip::plausibility
