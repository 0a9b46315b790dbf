#include "vision/outline/follower.h"

#include <cmath>

namespace flextip {
namespace {

// Weight of a new check in the agreement with the tags; agreement from which an outline is believed
// without the tags; frames checked at first, and then one frame in so many.
constexpr double kNewAgreement = 0.3, kBelieved = 0.5;
constexpr int kFirstChecks = 4, kCheckEvery = 5;

}  // namespace

OutlineFollower::OutlineFollower(const std::vector<CameraCalibration>& cameras,
                                 const TrackerOptions& options)
    : options_(options), outline_(cameras, *options.tube, options.outline) {}

void OutlineFollower::Join(const std::vector<const Image*>& images, Sight& sight) {
  if (sight.source != TrackSource::kPixels || sight.ambiguous) return;
  for (std::size_t i = 0; i < sight.pixels.views.size(); ++i) {
    const ViewFit& view = sight.pixels.views[i];
    const Eigen::Vector3d& blur_px2 = view.learned.mean.blur_px2;
    if (view.faces.empty()) continue;
    outline_.SetBlur(i, std::sqrt(std::max(0.0, 0.5 * (blur_px2[0] + blur_px2[2]))));
  }
  const TipPrediction seen{sight.T_RE, sight.covariance};
  const bool wanted = DirectionNoise(seen) >= options_.outline_from_rad;
  const bool due = ++frames_since_ >= kCheckEvery || checks_ < kFirstChecks;
  if (!wanted && !due) return;
  const auto joined = outline_.Join(images, seen);
  frames_since_ = 0;
  ++checks_;
  agreement_ += kNewAgreement * ((joined && joined->end_seen ? 1 : 0) - agreement_);
  if (!joined || !wanted) return;
  sight.T_RE = joined->tip.T_RE;
  sight.covariance = joined->tip.covariance;
  sight.outline_used = true;
}

void OutlineFollower::LeaveFrom(const ConstantVelocityFilter& filter, TimeNs t_ns) {
  by_tags_ = filter;
  last_seen_ns_ = t_ns;
}

// Returns the prior without the outline, about the outline's last place. The outline's errors
// (light, blur) are much the same from frame to frame: a frame must not gain from earlier outlines.
TipPrediction OutlineFollower::Prior(TimeNs t_ns, const TipPrediction& expected,
                                     const std::optional<TipPrediction>& model) const {
  const Eigen::Matrix3d moved_m2 = by_tags_->At(t_ns).covariance_m2;
  if (model && model->covariance.bottomRightCorner<3, 3>().trace() < moved_m2.trace()) {
    return *model;
  }
  TipPrediction prior = expected;
  const double sd_rad = 0.01 + 0.5e-9 * static_cast<double>(t_ns - last_seen_ns_);
  prior.covariance.setZero();
  prior.covariance.topLeftCorner<3, 3>() = sd_rad * sd_rad * Eigen::Matrix3d::Identity();
  prior.covariance.bottomRightCorner<3, 3>() = moved_m2;
  return prior;
}

std::optional<TipPrediction> OutlineFollower::Follow(const std::vector<const Image*>& images,
                                                     TimeNs t_ns, const TipPrediction& expected,
                                                     const std::optional<TipPrediction>& model) {
  const bool recent = by_tags_ && t_ns - last_seen_ns_ <= options_.max_outline_ns;
  if (!recent || agreement_ < kBelieved) return {};
  auto found = outline_.Find(images, Prior(t_ns, expected, model));
  if (!found || PositionSd(*found) > options_.max_predicted_sd_m) return {};
  return found;
}

void OutlineFollower::VisitState(StateText& state) {
  state(outline_);
  if (state.IsThere(by_tags_.has_value())) {
    if (!by_tags_) by_tags_.emplace(options_.acceleration_noise_m_s2);
    state(*by_tags_);
  } else {
    by_tags_.reset();
  }
  state(last_seen_ns_);
  for (int* count : {&checks_, &frames_since_}) state(*count);
  state(agreement_);
}

}  // namespace flextip
