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
#include "vision/collar_pose.h"
#include "vision/photometric_fit.h"
#include "vision/shaft_contour.h"
#include "vision/tag_detector.h"
#include "vision/tip_prediction.h"

namespace flextip {

struct TrackerOptions {
  TagDetectorOptions detector;  ///< its family is taken from the collar
  CollarPoseOptions pose;
  PhotometricOptions photometric;
  bool photometric_fit = true;  ///< false: the tags' corners alone
  /// A lost tip is looked for on a thread; what it finds counts some frames later. For live
  /// pictures; false gives the same result on every machine.
  bool background_detection = false;
  int max_predicted_frames = 3;  ///< then the tip is lost, unless a model is given
  TimeNs max_prediction_ns = 200'000'000;
  double max_predicted_sd_m = 0.01;  ///< a prediction less certain than this is none
  /// What is seen less certainly (one small tag, a blurred one) counts as predicted: the tip per
  /// axis, and the turn.
  double max_ok_sd_m = 0.0005, max_ok_sd_rad = 0.01;
  double acceleration_noise_m_s2 = 1.0;            ///< how fast a prediction's covariance grows
  double gamma_guess = 2.2, gamma_guess_sd = 0.4;  ///< where the camera's is not known
  /// The shaft before the cameras, where its outline is to be used: beside tags that leave its
  /// direction less certain than `outline_from_rad`, and to carry a prediction on while they hide.
  std::optional<TubeShape> tube;
  ContourOptions outline;
  double outline_from_rad = 0.003;
  TimeNs max_outline_ns = 2'000'000'000;  ///< so long the outline alone may carry a prediction
  double print_offset_sd_m = 3e-5;  ///< how well the tags' places along their normals are known
};

/// How a frame's pose was found.
enum class TrackSource { kNone, kCorners, kPixels };

/// What one frame said.
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
  bool outline_used = false;                ///< the shaft\'s outline is in the pose
  bool ambiguous = false;                   ///< another pose fits nearly as well
  std::optional<Pose> alternative_T_RE;     ///< that pose, or a clearly worse one
  double direction_noise_rad = 0.0;         ///< of d_RE, per axis across it, where kOk
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

  /// `model`: where wrist and shaft model expect the tip. Throws InputError where the image is
  /// empty or its size is not the camera's.
  TipTrack Track(const Image& image, TimeNs t_ns, const std::optional<TipPrediction>& model = {});

  /// One image a camera, taken at the same time; null where a camera has none.
  TipTrack Track(const std::vector<const Image*>& images, TimeNs t_ns,
                 const std::optional<TipPrediction>& model = {});

  /// All that the frames so far have left: a tracker of the same cameras, collar and options that
  /// reads it goes on as this one would. Not what a detection in the background is at.
  void VisitState(StateText& state);

  /// From tags that were detected elsewhere, in the first camera.
  TipTrack Track(const std::vector<TagDetection>& tags, TimeNs t_ns);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
