#include "plausibility/pictures/collar_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vision/tags/collar_pose.h"

namespace flextip::plausibility {
namespace {

/// Returns the RMS distance of the corners (px per degree of freedom), or -1 where none can be
/// fitted.
double RmsOf(const CameraModel& camera, TagCollar collar, const Detections& detections,
             double factor) {
  CollarPoseOptions options;
  options.max_rms_px = 1e6;
  for (CollarTag& tag : collar.tags) tag.size_m *= factor;
  double squares = 0.0;
  int dof = 0;
  for (const auto& tags : detections) {
    const CollarPose pose = EstimateCollarPose(camera, collar, tags, options);
    if (!pose.IsUsable() || pose.tags_used < 2) continue;
    squares += pose.squared_error_px2;
    dof += pose.dof;
  }
  return dof > 0 ? std::sqrt(squares / dof) : -1.0;
}

}  // namespace

std::vector<Frame> SomeFrames(FrameSource& source, std::size_t pictures, double share) {
  std::vector<Frame> frames;
  const auto all = static_cast<std::size_t>(share * static_cast<double>(source.Count()));
  const std::size_t stride = all > pictures && pictures > 0 ? all / pictures : 1;
  while (frames.size() < pictures) {
    auto frame = source.Next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
    source.Skip(stride - 1);
  }
  return frames;
}

Detections DetectTags(const std::vector<Frame>& frames, const std::string& family) {
  TagDetectorOptions options;
  options.family = family;
  // Small families have codes everywhere: only those that need no correction count.
  if (family != "tag36h11") options.max_hamming = 0;
  TagDetector detector(options);
  Detections detections;
  for (const Frame& frame : frames) detections.push_back(detector.Detect(frame.image));
  return detections;
}

std::size_t PicturesWithTags(const Detections& detections) {
  return static_cast<std::size_t>(std::count_if(detections.begin(), detections.end(),
                                                [](const auto& tags) { return !tags.empty(); }));
}

std::size_t TagsIn(const Detections& detections) {
  std::size_t count = 0;
  for (const auto& tags : detections) count += tags.size();
  return count;
}

std::optional<std::string> OtherFamily(const std::vector<Frame>& frames, const std::string& stated,
                                       std::size_t with_stated) {
  std::optional<std::string> best;
  std::size_t most = with_stated;
  for (const char* family : {"tag36h11", "tag36h10", "tag25h9", "tag16h5", "tagCircle21h7",
                             "tagStandard41h12", "tagStandard52h13"}) {
    if (family == stated) continue;
    const std::size_t with = PicturesWithTags(DetectTags(frames, family));
    if (with > most) most = with, best = family;
  }
  return 2 * most >= frames.size() ? best : std::nullopt;
}

std::optional<SizeFit> FitSize(const CameraModel& camera, const TagCollar& collar,
                               const Detections& detections) {
  SizeFit fit;
  fit.stated_rms_px = fit.rms_px = RmsOf(camera, collar, detections, 1.0);
  if (fit.stated_rms_px < 0.0) return {};
  for (int i = -40; i <= 40; ++i) {
    const double factor = std::exp(0.02 * i);
    const double rms = RmsOf(camera, collar, detections, factor);
    if (rms >= 0.0 && rms < fit.rms_px) fit.rms_px = rms, fit.factor = factor;
  }
  return fit;
}

}  // namespace flextip::plausibility
