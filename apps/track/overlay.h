// What vision found, drawn into the picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/tag_collar.h"
#include "recording/frames/frame_sets.h"
#include "recording/frames/frames.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

/// Outlines and ids of tags; green where the corners were fitted to the edges, else yellow.
void DrawTags(Image& image, const std::vector<TagDetection>& tags);

/// Tags, the faces of the fitted collar (cyan, those turned away thinner and dimmer), the axes of E
/// (x red, y green, z blue, 10 mm), the ellipse that holds the tip with 99 %, and the status in its
/// colour.
void DrawTrack(Image& image, const TipTrack& track, const CameraCalibration& camera,
               const TagCollar& collar);

/// The status in its colour, and what the fit leaves.
void DrawStatus(Image& image, const TipTrack& track);

/// Draws tracked frames into FOLDER/overlay.mp4, where that is wanted, and a few into
/// FOLDER/overlay/*.png: some spread evenly, and the first ones after the status
/// changed; of large frames the half around tip and tags.
class OverlayWriter {
 public:
  /// `frames` 0: not known.
  OverlayWriter(const std::filesystem::path& folder, std::size_t frames, double rate_hz,
                bool video);

  /// The first camera's picture; a set without it is passed over.
  void Add(const FrameSet& frames, const TipTrack& track, const CameraCalibration& camera,
           const TagCollar& collar);
  void Finish();
  /// Returns whether browsers play the video; true where there is none.
  bool PlaysInBrowsers() const { return !video_ || video_->PlaysInBrowsers(); }

 private:
  bool WantsPicture(TipStatus status);
  void FollowWindow(const TipTrack& track, const CameraCalibration& camera);

  std::filesystem::path folder_;
  std::size_t pictures_, every_, count_ = 0, of_changes_ = 0;
  std::optional<TipStatus> last_status_;
  Eigen::Vector2d window_px_ = Eigen::Vector2d::Zero();  // where tip and tags were last
  std::optional<VideoFile> video_;
};

}  // namespace flextip
