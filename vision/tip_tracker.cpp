#include "vision/tip_tracker.h"

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/rotation.h"
#include "vision/tip_filter.h"

namespace flextip {
namespace {

// How much of the corner noise seen so far is remembered from frame to frame.
constexpr double kNoiseMemory = 0.9;

void CheckCollar(const TagCollar& collar) {
  if (collar.tags.empty()) throw InputError("the tag collar has no tags");
  std::set<int> ids;
  for (const CollarTag& tag : collar.tags) {
    if (!(tag.size_m > 0) || !std::isfinite(tag.size_m)) {
      throw InputError(
          fmt::format("tag {}: size_m must be positive, found {}", tag.id, tag.size_m));
    }
    if (!ids.insert(tag.id).second) throw InputError(fmt::format("tag {} is there twice", tag.id));
  }
}

TagDetectorOptions DetectorFor(const TagCollar& collar, TagDetectorOptions options) {
  options.family = collar.family;
  return options;
}

}  // namespace

struct TipTracker::Impl {
  CameraModel camera;
  TagCollar collar;
  TrackerOptions options;
  TagDetector detector;
  TipFilter filter;
  std::optional<Pose> last_T_CE;  // of the last frame in which the collar was seen
  int predicted_frames = 0;
  double noise_sum_px2, noise_dof;  // squared corner errors so far, fading, and their freedom

  Impl(const CameraCalibration& c, const TagCollar& t, const TrackerOptions& o)
      : camera(c),
        collar(t),
        options(o),
        detector(DetectorFor(t, o.detector)),
        filter(o.acceleration_noise_m_s2),
        noise_sum_px2(o.pose.prior_variance_px2 * o.pose.prior_dof),
        noise_dof(o.pose.prior_dof) {
    CheckCollar(t);
  }

  void ForgetIfStale(TimeNs t_ns);
  CollarPose EstimatePose(const std::vector<TagDetection>& tags);
  void Report(const CollarPose& pose, TipTrack& track) const;
  void Predict(TimeNs t_ns, TipTrack& track);
};

void TipTracker::Impl::ForgetIfStale(TimeNs t_ns) {
  if (!filter.Started()) return;
  const TimeNs age = t_ns - filter.LastTime();
  if (age > 0 && age <= options.max_prediction_ns) return;
  filter.Reset();
  last_T_CE.reset();
}

CollarPose TipTracker::Impl::EstimatePose(const std::vector<TagDetection>& tags) {
  CollarPoseOptions pose_options = options.pose;
  pose_options.prior_variance_px2 = noise_dof > 0 ? noise_sum_px2 / noise_dof : 0.0;
  pose_options.prior_dof = noise_dof;
  const CollarPose pose = EstimateCollarPose(camera, collar, tags, pose_options, last_T_CE);
  if (pose.IsUsable()) {
    noise_sum_px2 = kNoiseMemory * noise_sum_px2 + pose.squared_error_px2;
    noise_dof = kNoiseMemory * noise_dof + pose.dof;
  }
  return pose;
}

// From the camera to R: p_RE = R_RC p_CE + p_RC.
void TipTracker::Impl::Report(const CollarPose& pose, TipTrack& track) const {
  const Pose& T_RC = camera.Calibration().T_RC;
  track.T_RE = T_RC * pose.T_CE;
  track.rms_px = pose.rms_px;
  track.tip.status = TipStatus::kOk;
  track.tip.p_RE = track.T_RE.p;
  track.tip.covariance_m2 = T_RC.R * pose.covariance.bottomRightCorner<3, 3>() * T_RC.R.transpose();
  track.tip.d_RE = track.T_RE.R.col(0);
  // A rotation dw turns the direction d by dw x d.
  const Eigen::Matrix3d turn = Skew(pose.T_CE.R.col(0));
  const Eigen::Matrix3d of_direction =
      turn * pose.covariance.topLeftCorner<3, 3>() * turn.transpose();
  track.direction_noise_rad = std::sqrt(0.5 * of_direction.trace());
}

void TipTracker::Impl::Predict(TimeNs t_ns, TipTrack& track) {
  if (!filter.Started() || predicted_frames >= options.max_predicted_frames) return;
  ++predicted_frames;
  const TipFilter::Prediction prediction = filter.At(t_ns);
  track.tip.status = TipStatus::kPredicted;
  track.tip.p_RE = prediction.p;
  track.tip.covariance_m2 = prediction.covariance_m2;
}

TipTracker::TipTracker(const CameraCalibration& camera, const TagCollar& collar,
                       const TrackerOptions& options)
    : impl_(std::make_unique<Impl>(camera, collar, options)) {}
TipTracker::~TipTracker() = default;
TipTracker::TipTracker(TipTracker&&) noexcept = default;
TipTracker& TipTracker::operator=(TipTracker&&) noexcept = default;

TipTrack TipTracker::Track(const Image& image, TimeNs t_ns) {
  const CameraCalibration& c = impl_->camera.Calibration();
  if (image.Empty()) throw InputError("the image is empty");
  const bool fits = image.width_px == c.width_px && image.height_px == c.height_px;
  if (c.width_px > 0 && !fits) {
    throw InputError(fmt::format("expected an image of {}x{} pixels, found {}x{}", c.width_px,
                                 c.height_px, image.width_px, image.height_px));
  }
  return Track(impl_->detector.Detect(image), t_ns);
}

TipTrack TipTracker::Track(const std::vector<TagDetection>& tags, TimeNs t_ns) {
  TipTrack track;
  track.tags = tags;
  impl_->ForgetIfStale(t_ns);
  track.pose = impl_->EstimatePose(tags);
  if (track.pose.IsUsable()) {
    impl_->Report(track.pose, track);
    impl_->filter.Measure(t_ns, track.tip.p_RE, track.tip.covariance_m2);
    impl_->last_T_CE = track.pose.T_CE;
    impl_->predicted_frames = 0;
  } else {
    impl_->Predict(t_ns, track);
  }
  return track;
}

}  // namespace flextip
