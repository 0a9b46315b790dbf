// From a camera's frames to the instrument's tip, frame by frame.
#pragma once

#include <memory>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "core/time_series.h"
#include "core/tip_observation.h"
#include "vision/collar_pose.h"
#include "vision/tag_detector.h"

namespace flextip {

struct TrackerOptions {
  TagDetectorOptions detector;  ///< its family is taken from the collar
  CollarPoseOptions pose;
  int max_predicted_frames = 3;  ///< then the tip is lost
  TimeNs max_prediction_ns = 200'000'000;
  double acceleration_noise_m_s2 = 1.0;  ///< how fast a prediction's covariance grows
};

/// What one frame said.
struct TipTrack {
  TipObservation tip;                ///< in R; d_RE only where the tags were seen
  std::vector<TagDetection> tags;    ///< every tag detected, of the collar or not
  Pose T_RE;                         ///< means something where `tip.status` is kOk
  double rms_px = 0.0;               ///< corner distance of the fit, where kOk
  double direction_noise_rad = 0.0;  ///< of d_RE, per axis across it, where kOk
  CollarPose pose;                   ///< the fit in the camera frame
};

/// Follows one collar. Frames must come in increasing time; a frame that goes back in time starts
/// afresh.
class TipTracker {
 public:
  /// Throws InputError for a camera or a collar that cannot be used (no tags, sizes that are not
  /// positive, an id twice).
  TipTracker(const CameraCalibration& camera, const TagCollar& collar,
             const TrackerOptions& options = {});
  ~TipTracker();
  TipTracker(TipTracker&&) noexcept;
  TipTracker& operator=(TipTracker&&) noexcept;

  /// Throws InputError where the image is empty or its size is not the camera's.
  TipTrack Track(const Image& image, TimeNs t_ns);

  /// The same from tags that were detected elsewhere.
  TipTrack Track(const std::vector<TagDetection>& tags, TimeNs t_ns);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
