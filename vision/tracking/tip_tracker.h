// From the frames of one or more cameras to the instrument's tip, frame by frame.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/state_text.h"
#include "core/tag_collar.h"
#include "core/time_series.h"
#include "core/tip_observation.h"
#include "vision/tags/detector.h"
#include "vision/tracking/options.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {

/// The result of a frame.
struct TipTrack {
  TipObservation tip;              ///< in R; d_RE only where the tags were seen
  std::vector<TagDetection> tags;  ///< in the first camera: detected, or where the fit puts them
  TrackSource source = TrackSource::kNone;
  Pose T_RE;  ///< means something where `tip.status` is kOk
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of T_RE, (dw, dp) in R, where kOk
  double rms_px = 0.0;                      ///< corner distance of the fit, where kCorners
  double noise_grey = 0.0;                  ///< of a pixel about the fit, where kPixels
  int tags_used = 0;                        ///< in all cameras
  bool outline_used = false;                ///< the shaft's outline is in the pose
  bool ambiguous = false;                   ///< another pose fits nearly as well
  std::optional<Pose> alternative_T_RE;     ///< that pose, or a clearly worse one
  double direction_noise_rad = 0.0;         ///< of d_RE, per axis across it, where kOk
  TipDoubt doubt = TipDoubt::kNone;         ///< why the tip is not kOk although tags were seen
  /// Of the tags' tip from where wrist and shaft can have it, in standard deviations, and in R (m);
  /// where tags were seen and `allowed` was given.
  std::optional<double> wrist_deviations;
  Eigen::Vector3d from_wrist_m = Eigen::Vector3d::Zero();
};

/// Follows one collar. Frames must come in increasing time; a frame that goes back in time starts
/// afresh.
class TipTracker {
 public:
  /// Throws InputError for a camera or a collar that cannot be used (no tags, sizes that are not
  /// positive, an id twice).
  TipTracker(const CameraCalibration& camera, const TagCollar& collar,
             const TrackerOptions& options = {});
  TipTracker(const std::vector<CameraCalibration>& cameras, const TagCollar& collar,
             const TrackerOptions& options = {});
  ~TipTracker();
  TipTracker(TipTracker&&) noexcept;
  TipTracker& operator=(TipTracker&&) noexcept;

  /// Tracks the tip in an image; `model` is the tip that wrist and shaft model expect. Throws
  /// InputError where the image is empty or its size is not the camera's.
  TipTrack Track(const Image& image, TimeNs t_ns, const std::optional<TipPrediction>& model = {});

  /// Tracks in an image of each camera, taken at the same time; null where a camera has none. A tip
  /// outside `allowed`, where wrist and shaft can have it at all, is not kOk: `doubt` says so, and
  /// nothing of it is remembered.
  TipTrack Track(const std::vector<const Image*>& images, TimeNs t_ns,
                 const std::optional<TipPrediction>& model = {},
                 const std::optional<TipPrediction>& allowed = {});

  /// Carries the tip on without a look at images, as where they are known to be of another time.
  TipTrack Carry(TimeNs t_ns, const std::optional<TipPrediction>& model);

  /// Visits the state that the frames so far have left. A tracker of the same cameras, collar and
  /// options that reads the state goes on as this tracker would. The state of a detection in the
  /// background is not in it.
  void VisitState(StateText& state);

  /// Tracks from tags that were detected elsewhere, in the first camera.
  TipTrack Track(const std::vector<TagDetection>& tags, TimeNs t_ns);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
