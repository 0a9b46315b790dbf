// The collar's localiser: whether a tag that is fitted alone is where the collar's file has it.
#include <algorithm>

#include "vision/tracking/collar_localiser.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {
namespace {

constexpr int kStandingChecksSpared = 4;   // of a tag beside which no other was seen
constexpr double kMaxNeighbour_px = 60.0;  // about where a neighbour should be, it is looked for
constexpr double kContradiction = 6.0;     // standard deviations of two poses from each other

}  // namespace

std::set<int> CollarLocaliser::FacesOf(const Sight& sight) const {
  std::set<int> ids;
  for (const ViewFit& view : sight.pixels.views) {
    for (const FaceFit& face : view.faces) ids.insert(face.tag_id);
  }
  return ids;
}

// A tag alone fits a picture wherever the collar's file has it. So one that was never fitted
// together with another is looked at beside those that the detector finds, by the same test that
// corners must pass without an expected pose.
Sight CollarLocaliser::HeldAgainstCollar(const Images& images, Sight sight) {
  const std::set<int> faces = FacesOf(sight);
  if (collar_.tags.size() < 2 || faces.size() != 1) return sight;
  const auto tag = std::find_if(collar_.tags.begin(), collar_.tags.end(),
                                [&](const CollarTag& t) { return t.id == *faces.begin(); });
  int& standing = standings_[tag - collar_.tags.begin()];
  if (standing == kAgrees) return sight;
  if (standing_checks_spared_ > 0) {
    --standing_checks_spared_;
  } else {
    standing = Contradicts(images, sight) ? kContradicts : kUnknown;
    standing_checks_spared_ = standing == kContradicts ? 0 : kStandingChecksSpared;
  }
  if (standing != kContradicts) return sight;
  Sight nothing;
  nothing.tags = sight.tags;
  nothing.contradicts_collar = true;
  return nothing;
}

bool CollarLocaliser::Contradicts(const Images& images, const Sight& sight) {
  const std::set<int> faces = FacesOf(sight);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] == nullptr) continue;
    const auto tags = DetectNear(*images[i], i, sight.T_RE, kMaxNeighbour_px);
    const auto shows = [&](bool fitted) {
      return std::any_of(tags.begin(), tags.end(), [&](const TagDetection& t) {
        return faces.contains(t.id) == fitted &&
               std::any_of(collar_.tags.begin(), collar_.tags.end(),
                           [&](const CollarTag& c) { return c.id == t.id; });
      });
    };
    if (!shows(true) || !shows(false)) continue;
    CollarPoseOptions pose = options_.pose;
    pose.corner_noise_floor_px = kCornerFallback_px;
    const Sight corners = FromTags(i, tags, sight.T_RE, pose);
    if (!corners.Found()) return true;
    if (Deviations({sight.T_RE, sight.covariance}, {corners.T_RE, corners.covariance}) >
        kContradiction) {
      return true;
    }
  }
  return false;
}

}  // namespace flextip
