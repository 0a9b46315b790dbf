// A tracker's options, and the sources of a pose.
#pragma once

#include <optional>

#include "core/time_series.h"
#include "vision/outline/contour.h"
#include "vision/photometric/fit.h"
#include "vision/tags/collar_pose.h"
#include "vision/tags/detector.h"

namespace flextip {

struct TrackerOptions {
  TagDetectorOptions detector;  ///< its family is taken from the collar
  CollarPoseOptions pose;
  PhotometricOptions photometric;
  bool photometric_fit = true;  ///< false: the tags' corners alone
  /// A thread looks for a lost tip; its result counts some frames later. For live pictures; false
  /// gives the same result on every machine.
  bool background_detection = false;
  int max_predicted_frames = 3;  ///< then the tip is lost, unless a model is given
  TimeNs max_prediction_ns = 200'000'000;
  double max_predicted_sd_m = 0.01;  ///< a prediction less certain than this is none
  /// Limits for the tip per axis, and for the turn. A less certain tip (a single small tag, a
  /// blurred tag) counts as predicted.
  double max_ok_sd_m = 0.0005, max_ok_sd_rad = 0.01;
  double acceleration_noise_m_s2 = 1.0;            ///< how fast a prediction's covariance grows
  double gamma_guess = 2.2, gamma_guess_sd = 0.4;  ///< where the camera's is not known
  /// The shaft before the cameras, where its outline is to be used: beside tags that leave its
  /// direction less certain than `outline_from_rad`, and to carry a prediction on while they hide.
  std::optional<TubeShape> tube;
  ContourOptions outline;
  double outline_from_rad = 0.003;
  TimeNs max_outline_ns = 2'000'000'000;  ///< so long the outline alone may carry a prediction
  /// Of the tags' tip from where wrist and shaft can have it: beyond, it is no measurement.
  double max_wrist_deviations = 6.0;
  double print_offset_sd_m = 3e-5;  ///< how well the tags' places along their normals are known
};

/// How a frame's pose was found.
enum class TrackSource { kNone, kCorners, kPixels };

/// Why a tip that the tags show is no measurement.
enum class TipDoubt {
  kNone,
  kNotByWrist,   ///< wrist and shaft cannot have it there
  kNotByCollar,  ///< the tags are not where the collar has them, one from another
  kStandsStill,  ///< the same picture as before, while the wrist moved
};

/// Returns the name as in frames.csv: "none", "not_by_wrist", ...
inline const char* Name(TipDoubt doubt) {
  switch (doubt) {
    case TipDoubt::kNone:
      return "none";
    case TipDoubt::kNotByWrist:
      return "not_by_wrist";
    case TipDoubt::kNotByCollar:
      return "not_by_collar";
    case TipDoubt::kStandsStill:
      return "stands_still";
  }
  return "";
}

}  // namespace flextip
