// The collar in a few pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"
#include "core/tag_collar.h"
#include "recording/frames/frame_source.h"
#include "vision/camera_model.h"
#include "vision/tags/detector.h"

namespace flextip::plausibility {

using Detections = std::vector<std::vector<TagDetection>>;  ///< a list a picture

/// Returns `pictures` frames, spread over the first `share` of all.
std::vector<Frame> SomeFrames(FrameSource& source, std::size_t pictures, double share);

/// Returns the tags of a family in each frame.
Detections DetectTags(const std::vector<Frame>& frames, const std::string& family);
/// Returns the number of pictures with tags, and of tags in all.
std::size_t PicturesWithTags(const Detections& detections);
std::size_t TagsIn(const Detections& detections);

/// Returns the family, other than `stated`, of which most pictures show tags; empty where none is
/// shown by half of them and by more than `with_stated`.
std::optional<std::string> OtherFamily(const std::vector<Frame>& frames, const std::string& stated,
                                       std::size_t with_stated);

/// How the corners of pictures with two tags and more fit, with tags `factor` times as large on the
/// same collar.
struct SizeFit {
  double factor = 1.0;
  double rms_px = 0.0, stated_rms_px = 0.0;  ///< with the factor, and as stated
};
/// Returns the best size between 0.45 and 2.2 times the stated one; empty where no picture shows
/// two tags.
std::optional<SizeFit> FitSize(const CameraModel& camera, const TagCollar& collar,
                               const Detections& detections);

}  // namespace flextip::plausibility
