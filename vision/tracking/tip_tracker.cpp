#include "vision/tracking/tip_tracker.h"

#include <bit>
#include <cmath>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/rotation.h"
#include "vision/outline/follower.h"
#include "vision/tags/background_detector.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/collar_localiser.h"
#include "vision/tracking/constant_velocity_filter.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// How much of the corner noise seen so far is remembered from frame to frame.
constexpr double kNoiseMemory = 0.9;
constexpr double kMinSearch_px = 8.0, kMaxSearch_px = 60.0;
constexpr int kRemembered = 10;    // seen tips
constexpr int kThoroughEvery = 5;  // of the frames of a lost tip, at full resolution

const TagCollar& Checked(const TagCollar& collar) {
  if (collar.tags.empty()) throw InputError("the tag collar has no tags");
  std::set<int> ids;
  for (const CollarTag& tag : collar.tags) {
    if (!(tag.size_m > 0) || !std::isfinite(tag.size_m)) {
      throw InputError(
          fmt::format("tag {}: size_m must be positive, found {}", tag.id, tag.size_m));
    }
    if (!ids.insert(tag.id).second) throw InputError(fmt::format("tag {} is there twice", tag.id));
  }
  return collar;
}

void CheckImage(const Image& image, const CameraCalibration& c) {
  if (image.Empty()) throw InputError("the image is empty");
  if (image.channels != 1 && image.channels != 3) {
    throw InputError(fmt::format("expected an image of 1 or 3 channels, found {}", image.channels));
  }
  if (image.width_px != c.width_px || image.height_px != c.height_px) {
    throw InputError(fmt::format("expected an image of {}x{} pixels, found {}x{}", c.width_px,
                                 c.height_px, image.width_px, image.height_px));
  }
}

}  // namespace

struct TipTracker::Impl {
  TrackerOptions options;
  CollarLocaliser localiser;
  std::vector<CameraCalibration> cameras;
  ConstantVelocityFilter filter;
  std::optional<BackgroundDetector> background;
  std::optional<OutlineFollower> outline;

  std::optional<Pose> last_T_RE;         // of the last frame in which the collar was seen
  TimeNs last_ns = 0, last_seen_ns = 0;  // of last_T_RE, and of the last tags
  Eigen::Vector3d turn_rate = Eigen::Vector3d::Zero();  // rad/s
  int predicted_frames = 0, lost_frames = 0;
  int contradictions = 0;           // a bit a seen tip, the newest lowest: it was not allowed
  double noise_sum_px2, noise_dof;  // squared corner errors so far, fading, and their freedom

  Impl(const std::vector<CameraCalibration>& c, const TagCollar& collar, const TrackerOptions& o)
      : options(o),
        localiser(c, Checked(collar), o),
        cameras(c),
        filter(o.acceleration_noise_m_s2),
        noise_sum_px2(o.pose.prior_variance_px2 * o.pose.prior_dof),
        noise_dof(o.pose.prior_dof) {
    if (o.tube) outline.emplace(c, o);
    if (!o.background_detection) return;
    TagDetectorOptions detector = o.detector;
    detector.family = collar.family;
    background.emplace(detector);
  }

  void VisitState(StateText& state);
  void ForgetIfStale(TimeNs t_ns);
  std::optional<TipPrediction> Expect(TimeNs t_ns, const std::optional<TipPrediction>& model) const;
  double SearchRadius(const TipPrediction& expected) const;
  Sight Find(const Images& images, TimeNs t_ns, const std::optional<TipPrediction>& expected,
             const std::optional<TipPrediction>& allowed);
  bool IsAllowed(const Sight& sight, const std::optional<TipPrediction>& allowed) const {
    return !allowed ||
           Deviations({sight.T_RE, sight.covariance}, *allowed) <= options.max_wrist_deviations;
  }
  Sight FindLost(const Images& images, TimeNs t_ns, const std::optional<Pose>& near_T_RE);
  std::optional<TipPrediction> FollowOutline(const Images& images, TimeNs t_ns,
                                             const TipPrediction& expected,
                                             const std::optional<TipPrediction>& model);
  Sight FindFromTags(const std::vector<TagDetection>& tags);
  bool IsBelieved(const Sight& sight, const std::optional<TipPrediction>& allowed);
  TipTrack Finish(Sight sight, TimeNs t_ns, const std::optional<TipPrediction>& expected,
                  const std::optional<TipPrediction>& model, const Images& images,
                  const std::optional<TipPrediction>& allowed = {});
  void Carry(const Images& images, const Sight& sight, TimeNs t_ns,
             const std::optional<TipPrediction>& expected,
             const std::optional<TipPrediction>& model, TipTrack& track);
  void Remember(const Sight& sight, TimeNs t_ns);
  bool IsSure(const Sight& sight) const {
    return MaxSd(sight.covariance.bottomRightCorner<3, 3>()) <= options.max_ok_sd_m &&
           MaxSd(sight.covariance.topLeftCorner<3, 3>()) <= options.max_ok_sd_rad;
  }
  void Report(const Sight& sight, TipTrack& track) const;
};

void TipTracker::Impl::VisitState(StateText& state) {
  state(localiser);
  state(filter);
  state(last_T_RE);
  state(last_ns);
  state(last_seen_ns);
  state(turn_rate);
  for (int* count : {&predicted_frames, &lost_frames, &contradictions}) state(*count);
  for (double* value : {&noise_sum_px2, &noise_dof}) state(*value);
  if (state.IsThere(outline.has_value()) != outline.has_value()) {
    throw InputError("saved state: of a run with another choice of the outline");
  }
  if (outline) state(*outline);
}

void TipTracker::Impl::ForgetIfStale(TimeNs t_ns) {
  if (!filter.Started()) return;
  const TimeNs age = t_ns - filter.LastTime();
  if (age > 0 && age <= options.max_prediction_ns) return;
  filter.Reset();
  if (outline) outline->Forget();
  last_T_RE.reset();
  turn_rate.setZero();
  localiser.Forget();
}

// The better of what the model and the motion so far say.
std::optional<TipPrediction> TipTracker::Impl::Expect(
    TimeNs t_ns, const std::optional<TipPrediction>& model) const {
  if (!filter.Started() || !last_T_RE) return model;
  const ConstantVelocityFilter::Prediction moved = filter.At(t_ns);
  const double dt_s = 1e-9 * static_cast<double>(t_ns - last_ns);
  TipPrediction motion;
  motion.T_RE = {ExpRotation(dt_s * turn_rate) * last_T_RE->R, moved.p};
  motion.covariance.setZero();
  motion.covariance.topLeftCorner<3, 3>() =
      std::pow(0.01 + 0.5 * dt_s, 2) * Eigen::Matrix3d::Identity();
  motion.covariance.bottomRightCorner<3, 3>() = moved.covariance_m2;
  const auto spread = [](const TipPrediction& p) {
    return p.covariance.bottomRightCorner<3, 3>().trace();
  };
  return model && spread(*model) < spread(motion) ? *model : motion;
}

double TipTracker::Impl::SearchRadius(const TipPrediction& expected) const {
  const Pose T_CE = cameras[0].T_RC.Inverse() * expected.T_RE;
  const double sd_px = cameras[0].fu_px * MaxSd(expected.covariance.bottomRightCorner<3, 3>()) /
                       std::max(0.01, T_CE.p.z());
  return std::clamp(3 * sd_px, kMinSearch_px, kMaxSearch_px);
}

Sight TipTracker::Impl::Find(const Images& images, TimeNs t_ns,
                             const std::optional<TipPrediction>& expected,
                             const std::optional<TipPrediction>& allowed) {
  Sight sight;
  if (expected && localiser.MightSee(expected->T_RE)) {
    sight = localiser.FindNear(images, expected->T_RE, SearchRadius(*expected));
  }
  if (sight.Found() && IsAllowed(sight, allowed)) return sight;
  // The outline knows no roll: after a while it does not tell one planar pose from the other.
  const bool old_roll = last_ns > last_seen_ns && t_ns - last_seen_ns > options.max_prediction_ns;
  const std::optional<Pose> near_T_RE =
      expected && !old_roll ? std::optional<Pose>(expected->T_RE) : std::nullopt;
  Sight other = FindLost(images, t_ns, near_T_RE);
  return other.Found() || !(sight.Found() || sight.contradicts_collar) ? other : sight;
}

// The whole picture: now, or on the thread. What the thread found in an earlier picture is where
// this one is searched.
Sight TipTracker::Impl::FindLost(const Images& images, TimeNs t_ns,
                                 const std::optional<Pose>& near_T_RE) {
  if (!background) {
    const bool thorough = lost_frames++ % kThoroughEvery == 0;
    return localiser.FindAnywhere(images, near_T_RE, thorough);
  }
  Sight sight;
  if (const auto found = background->Take()) {
    const Sight then = localiser.FromTags(0, found->tags, near_T_RE, options.pose);
    if (then.Found()) sight = localiser.FindNear(images, then.T_RE, kMaxSearch_px);
  }
  if (!sight.Found() && images[0] != nullptr) background->Submit(*images[0], t_ns);
  return sight;
}

// The tags are covered: the outline keeps the prediction from growing.
std::optional<TipPrediction> TipTracker::Impl::FollowOutline(
    const Images& images, TimeNs t_ns, const TipPrediction& expected,
    const std::optional<TipPrediction>& model) {
  if (!outline || images.empty() || !last_T_RE) return {};
  const auto found = outline->Follow(images, t_ns, expected, model);
  if (!found) return {};
  filter.Replace(t_ns, found->T_RE.p, found->covariance.bottomRightCorner<3, 3>());
  last_T_RE = found->T_RE;
  last_ns = t_ns;
  return found;
}

Sight TipTracker::Impl::FindFromTags(const std::vector<TagDetection>& tags) {
  CollarPoseOptions pose = options.pose;
  pose.prior_variance_px2 = noise_dof > 0 ? noise_sum_px2 / noise_dof : 0.0;
  pose.prior_dof = noise_dof;
  const Sight sight = localiser.FromTags(0, tags, last_T_RE, pose);
  if (sight.Found()) {
    noise_sum_px2 = kNoiseMemory * noise_sum_px2 + sight.squared_error_px2;
    noise_dof = kNoiseMemory * noise_dof + sight.dof;
  }
  return sight;
}

void TipTracker::Impl::Remember(const Sight& sight, TimeNs t_ns) {
  filter.Measure(t_ns, sight.T_RE.p, sight.covariance.bottomRightCorner<3, 3>());
  turn_rate.setZero();
  if (last_T_RE && last_ns == last_seen_ns) {  // the outline knows no roll
    const double dt_s = 1e-9 * static_cast<double>(t_ns - last_ns);
    turn_rate = LogRotation(sight.T_RE.R * last_T_RE->R.transpose()) / dt_s;
  }
  last_T_RE = sight.T_RE;
  last_ns = last_seen_ns = t_ns;
  predicted_frames = lost_frames = 0;
  localiser.Learn(sight);
  if (outline) outline->LeaveFrom(filter, t_ns);
}

void TipTracker::Impl::Report(const Sight& sight, TipTrack& track) const {
  track.tip.status = TipStatus::kOk;
  track.T_RE = sight.T_RE;
  track.covariance = sight.covariance;
  track.tip.p_RE = sight.T_RE.p;
  track.tip.covariance_m2 = sight.covariance.bottomRightCorner<3, 3>();
  track.tip.d_RE = sight.T_RE.R.col(0);
  track.direction_noise_rad = DirectionNoise({sight.T_RE, sight.covariance});
}

// Where most of the last tips contradict the wrist, one that happens to lie near is no better: late
// or shuffled pictures come by the right place.
bool TipTracker::Impl::IsBelieved(const Sight& sight, const std::optional<TipPrediction>& allowed) {
  if (!allowed) return true;
  const bool is_allowed = IsAllowed(sight, allowed);
  contradictions = ((contradictions << 1) | (is_allowed ? 0 : 1)) & ((1 << kRemembered) - 1);
  return is_allowed && std::popcount(static_cast<unsigned>(contradictions)) <= kRemembered / 2;
}

TipTrack TipTracker::Impl::Finish(Sight sight, TimeNs t_ns,
                                  const std::optional<TipPrediction>& expected,
                                  const std::optional<TipPrediction>& model, const Images& images,
                                  const std::optional<TipPrediction>& allowed) {
  TipTrack track;
  if (sight.Found() && allowed) {
    track.wrist_deviations = Deviations({sight.T_RE, sight.covariance}, *allowed);
    track.from_wrist_m = sight.T_RE.p - allowed->T_RE.p;
  }
  if (sight.contradicts_collar) track.doubt = TipDoubt::kNotByCollar;
  const bool by_images = !images.empty();
  track.tags = sight.tags;
  track.source = sight.source;
  track.rms_px = sight.rms_px;
  track.noise_grey = sight.noise_grey;
  track.tags_used = sight.tags_used;
  track.outline_used = sight.outline_used;
  track.ambiguous = sight.ambiguous;
  track.alternative_T_RE = sight.alternative_T_RE;
  if (sight.Found() && !IsBelieved(sight, allowed)) {
    track.doubt = TipDoubt::kNotByWrist;
    sight.source = TrackSource::kNone;  // from here on as if nothing had been seen
  }
  // Corners that the pixels do not confirm (covered, blurred) are no measurement to rely on.
  const bool confirmed =
      sight.source == TrackSource::kPixels || !options.photometric_fit || !by_images;
  if (confirmed && sight.Found() && IsSure(sight)) {
    Report(sight, track);
    Remember(sight, t_ns);
    return track;
  }
  Carry(images, sight, t_ns, expected, model, track);
  if (confirmed && sight.Found() && !sight.ambiguous && !track.outline_used) Remember(sight, t_ns);
  return track;
}

// The tags were not seen, or not well: the best of what they say, the outline and the expectation.
void TipTracker::Impl::Carry(const Images& images, const Sight& sight, TimeNs t_ns,
                             const std::optional<TipPrediction>& expected,
                             const std::optional<TipPrediction>& model, TipTrack& track) {
  std::optional<TipPrediction> best = expected;
  bool measured = false;
  const auto consider = [&](const std::optional<TipPrediction>& other) {
    if (!other || (best && PositionSd(*best) < PositionSd(*other))) return false;
    best = other;
    return measured = true;
  };
  if (sight.Found()) consider(TipPrediction{sight.T_RE, sight.covariance});
  if (expected) track.outline_used = consider(FollowOutline(images, t_ns, *expected, model));
  const bool patient = measured || model || predicted_frames < options.max_predicted_frames;
  if (!best || !patient || PositionSd(*best) > options.max_predicted_sd_m) return;
  if (!measured) ++predicted_frames;
  track.tip.status = TipStatus::kPredicted;
  track.tip.p_RE = best->T_RE.p;
  track.tip.covariance_m2 = best->covariance.bottomRightCorner<3, 3>();
}

TipTracker::TipTracker(const CameraCalibration& camera, const TagCollar& collar,
                       const TrackerOptions& options)
    : TipTracker(std::vector<CameraCalibration>{camera}, collar, options) {}
TipTracker::TipTracker(const std::vector<CameraCalibration>& cameras, const TagCollar& collar,
                       const TrackerOptions& options)
    : impl_(std::make_unique<Impl>(cameras, collar, options)) {}
TipTracker::~TipTracker() = default;
TipTracker::TipTracker(TipTracker&&) noexcept = default;
TipTracker& TipTracker::operator=(TipTracker&&) noexcept = default;

TipTrack TipTracker::Track(const Image& image, TimeNs t_ns,
                           const std::optional<TipPrediction>& model) {
  return Track(Images{&image}, t_ns, model);
}

TipTrack TipTracker::Track(const std::vector<const Image*>& images, TimeNs t_ns,
                           const std::optional<TipPrediction>& model,
                           const std::optional<TipPrediction>& allowed) {
  if (images.size() != impl_->cameras.size()) {
    throw InputError(fmt::format("expected {} images, one a camera, found {}",
                                 impl_->cameras.size(), images.size()));
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] != nullptr) CheckImage(*images[i], impl_->cameras[i]);
  }
  impl_->ForgetIfStale(t_ns);
  const std::optional<TipPrediction> expected = impl_->Expect(t_ns, model);
  Sight sight = impl_->Find(images, t_ns, expected, allowed);
  if (impl_->outline) impl_->outline->Join(images, sight);
  return impl_->Finish(std::move(sight), t_ns, expected, model, images, allowed);
}

TipTrack TipTracker::Carry(TimeNs t_ns, const std::optional<TipPrediction>& model) {
  impl_->ForgetIfStale(t_ns);
  return impl_->Finish({}, t_ns, impl_->Expect(t_ns, model), model, {});
}

void TipTracker::VisitState(StateText& state) { impl_->VisitState(state); }

TipTrack TipTracker::Track(const std::vector<TagDetection>& tags, TimeNs t_ns) {
  impl_->ForgetIfStale(t_ns);
  const std::optional<TipPrediction> expected = impl_->Expect(t_ns, {});
  return impl_->Finish(impl_->FindFromTags(tags), t_ns, expected, {}, {});
}

}  // namespace flextip
