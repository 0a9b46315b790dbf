#include "vision/tracking/collar_localiser.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rotation.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {
namespace {

constexpr double kMinSearchCorrelation = 0.35;
constexpr double kMaxTurn_rad = 0.5, kMaxTurnUnsure_rad = 0.25;  // from one picture to the next
constexpr double kFirstBlurSd_px2 = 3.0;
constexpr double kLinearGamma = 1.0;  // the second guess where a camera's is not known
constexpr int kDetectMargin_px = 12;

TagDetectorOptions DetectorFor(const TagCollar& collar, TagDetectorOptions options) {
  options.family = collar.family;
  return options;
}

Image Crop(const Image& image, int x0, int y0, int width, int height) {
  Image crop(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* from = image.Row(y0 + y) + static_cast<std::ptrdiff_t>(x0) * image.channels;
    std::copy(from, from + static_cast<std::ptrdiff_t>(width) * image.channels, crop.Row(y));
  }
  return crop;
}

}  // namespace

CollarLocaliser::CollarLocaliser(const std::vector<CameraCalibration>& cameras,
                                 const TagCollar& collar, const TrackerOptions& options)
    : collar_(collar),
      options_(options),
      detector_(DetectorFor(collar, options.detector)),
      fit_(cameras, collar, options.photometric) {
  for (const CameraCalibration& camera : cameras) {
    models_.push_back(std::make_unique<CameraModel>(camera));
    searches_.emplace_back(*models_.back(), collar);
    OpticsPrior prior;
    prior.mean.gamma = camera.gamma.value_or(options.gamma_guess);
    prior.gamma_sd = camera.gamma ? 0.0 : options.gamma_guess_sd;
    prior.print_offset_sd_m = options.print_offset_sd_m;
    prior.blur_sd_px2 = kFirstBlurSd_px2;
    priors_.push_back(prior);
  }
  standings_.assign(collar.tags.size(), kUnknown);
}

void CollarLocaliser::Forget() {
  noise_grey_ = 0;
  planar_checks_spared_ = 0;
  for (OpticsPrior& prior : priors_) {
    prior.mean.blur_px2 = Optics().blur_px2;
    prior.blur_sd_px2 = kFirstBlurSd_px2;
  }
}

void CollarLocaliser::Learn(const Sight& sight) {
  if (sight.source != TrackSource::kPixels) return;
  const std::set<int> faces = FacesOf(sight);
  for (std::size_t i = 0; i < standings_.size(); ++i) {
    if (faces.size() > 1 && faces.contains(collar_.tags[i].id)) standings_[i] = kAgrees;
  }
  noise_grey_ = noise_grey_ > 0 ? 0.8 * noise_grey_ + 0.2 * sight.noise_grey : sight.noise_grey;
  for (std::size_t i = 0; i < priors_.size(); ++i) {
    if (sight.pixels.views[i].noise_grey > 0) priors_[i] = sight.pixels.views[i].learned;
  }
}

void CollarLocaliser::VisitState(StateText& state) {
  state(noise_grey_);
  state(planar_checks_spared_);
  state(standing_checks_spared_);
  for (int& standing : standings_) state(standing);
  for (OpticsPrior& prior : priors_) {
    state(prior.mean.blur_px2);
    for (double* value : {&prior.mean.gamma, &prior.mean.print_offset_m, &prior.blur_sd_px2,
                          &prior.gamma_sd, &prior.print_offset_sd_m, &prior.noise_grey}) {
      state(*value);
    }
  }
}

bool CollarLocaliser::MightSee(const Pose& T_RE) const {
  for (const auto& model : models_) {
    const CameraCalibration& c = model->Calibration();
    for (const CollarTag& tag : collar_.tags) {
      const auto px = model->Project(c.T_RC.Inverse() * (T_RE * tag.T_EG.p));
      const bool inside = px && px->x() > -20 && px->y() > -20 && px->x() < c.width_px + 20 &&
                          px->y() < c.height_px + 20;
      if (inside) return true;
    }
  }
  return false;
}

Sight CollarLocaliser::FitPixels(const Images& images, const Pose& T_RE, bool coarse,
                                 const PhotometricResult* rival) {
  Sight sight;
  sight.pixels = fit_.Fit(images, T_RE, priors_, coarse, rival);
  if (!sight.pixels.IsUsable()) return sight;
  for (const ViewFit& view : sight.pixels.views) {
    sight.noise_grey = std::max(sight.noise_grey, view.noise_grey);
  }
  sight.source = TrackSource::kPixels;
  sight.T_RE = sight.pixels.T_RE;
  sight.covariance = sight.pixels.covariance;
  sight.tags_used = sight.pixels.faces;
  sight.tags = PredictedTags(sight.pixels);
  return sight;
}

// Whether the tags that should be in view are.
bool CollarLocaliser::IsComplete(const Sight& sight) const {
  return sight.pixels.faces >= sight.pixels.faces_in_view;
}

// Another minimum leaves more than the noise of the pictures before, turns far from what was
// expected, or would show tags that are not there.
bool CollarLocaliser::IsTrusted(const Sight& sight, const Pose& expected_T_RE) const {
  if (!sight.Found()) return false;
  const double turn = PoseDifference(expected_T_RE, sight.T_RE).head<3>().norm();
  const bool sure = IsComplete(sight) && !sight.pixels.one_plane;
  if (turn > (sure ? kMaxTurn_rad : kMaxTurnUnsure_rad)) return false;
  return noise_grey_ <= 0 || sight.noise_grey < 1.6 * noise_grey_ + 0.5;
}

std::vector<TagDetection> CollarLocaliser::PredictedTags(const PhotometricResult& fit) const {
  std::vector<TagDetection> tags;
  const Pose T_CE = models_[0]->Calibration().T_RC.Inverse() * fit.T_RE;
  for (const FaceFit& face : fit.views[0].faces) {
    const auto tag = std::find_if(collar_.tags.begin(), collar_.tags.end(),
                                  [&](const CollarTag& t) { return t.id == face.tag_id; });
    TagDetection detection;
    detection.id = face.tag_id;
    detection.decision_margin = 0.5 * face.contrast;
    detection.refined = true;
    const auto corners_E = CornersInE(*tag);
    for (int i = 0; i < 4; ++i) {
      const auto px = models_[0]->Project(T_CE * corners_E[i]);
      if (px) detection.corners_px[i] = *px;
      detection.raw_corners_px[i] = detection.corners_px[i] + Eigen::Vector2d(0.5, 0.5);
    }
    tags.push_back(detection);
  }
  return tags;
}

Sight CollarLocaliser::FindNear(const Images& images, const Pose& T_RE, double radius_px) {
  bool contradicts = false;
  if (options_.photometric_fit) {
    Sight sight = FitPixels(images, T_RE, false);
    for (std::size_t i = 0; i < images.size() && !IsTrusted(sight, T_RE); ++i) {
      if (images[i] == nullptr) continue;
      const Pose& T_RC = models_[i]->Calibration().T_RC;
      const Pose T_CE = T_RC.Inverse() * T_RE;
      const CollarSearch::Match match = searches_[i].Find(*images[i], T_CE, radius_px);
      if (match.correlation < kMinSearchCorrelation) continue;
      sight = FitPixels(images, T_RC * searches_[i].Shifted(T_CE, match.shift_px));
    }
    if (IsTrusted(sight, T_RE)) {
      if (!MaySkipPlanarCheck(sight, T_RE)) CheckOtherPlanarPose(images, T_RE, sight);
      if (IsTrusted(sight, T_RE)) {
        sight = HeldAgainstCollar(images, std::move(sight));
        if (sight.Found()) return sight;
        contradicts = true;
      }
    }
  }
  std::vector<std::vector<TagDetection>> tags(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] != nullptr) tags[i] = DetectNear(*images[i], i, T_RE, radius_px);
  }
  Sight sight = Acquired(images, BestOf(tags, T_RE), T_RE);
  sight.contradicts_collar |= contradicts && !sight.Found();
  return sight;
}

std::vector<TagDetection> CollarLocaliser::DetectNear(const Image& image, std::size_t camera,
                                                      const Pose& T_RE, double radius_px) {
  const Pose T_CE = models_[camera]->Calibration().T_RC.Inverse() * T_RE;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const CollarTag& tag : collar_.tags) {
    for (const Eigen::Vector3d& corner : CornersInE(tag)) {
      const auto px = models_[camera]->Project(T_CE * corner);
      if (!px) continue;
      low = low.cwiseMin(*px);
      high = high.cwiseMax(*px);
    }
  }
  const double margin = radius_px + kDetectMargin_px + 0.1 * (high - low).maxCoeff();
  const int x0 = static_cast<int>(std::clamp(low.x() - margin, 0.0, image.width_px - 1.0));
  const int y0 = static_cast<int>(std::clamp(low.y() - margin, 0.0, image.height_px - 1.0));
  const int x1 = static_cast<int>(std::clamp(high.x() + margin, 0.0, image.width_px - 1.0));
  const int y1 = static_cast<int>(std::clamp(high.y() + margin, 0.0, image.height_px - 1.0));
  if (x1 - x0 < 16 || y1 - y0 < 16) return {};
  auto tags = detector_.Detect(Crop(image, x0, y0, x1 - x0 + 1, y1 - y0 + 1));
  for (TagDetection& tag : tags) {
    for (auto* corners : {&tag.corners_px, &tag.raw_corners_px}) {
      for (Eigen::Vector2d& corner : *corners) corner += Eigen::Vector2d(x0, y0);
    }
  }
  return tags;
}

Sight CollarLocaliser::FindAnywhere(const Images& images, const std::optional<Pose>& near_T_RE,
                                    bool thorough) {
  std::vector<std::vector<TagDetection>> tags(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] != nullptr) tags[i] = detector_.Detect(*images[i], thorough ? 1.0 : 2.0);
  }
  return Acquired(images, BestOf(tags, near_T_RE), near_T_RE);
}

// The camera that knows best decides.
Sight CollarLocaliser::BestOf(const std::vector<std::vector<TagDetection>>& tags,
                              const std::optional<Pose>& near_T_RE) const {
  CollarPoseOptions options = options_.pose;
  if (options_.photometric_fit) options.corner_noise_floor_px = kCornerFallback_px;
  const auto spread = [](const Sight& s) { return s.covariance.bottomRightCorner<3, 3>().trace(); };
  Sight best;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const Sight sight = FromTags(i, tags[i], near_T_RE, options);
    if (sight.Found() && (!best.Found() || spread(sight) < spread(best))) best = sight;
  }
  best.tags = tags[0];
  return best;
}

Sight CollarLocaliser::FromTags(std::size_t camera, const std::vector<TagDetection>& tags,
                                const std::optional<Pose>& near_T_RE,
                                const CollarPoseOptions& options) const {
  const Pose& T_RC = models_[camera]->Calibration().T_RC;
  std::optional<Pose> near_T_CE;
  if (near_T_RE) near_T_CE = T_RC.Inverse() * *near_T_RE;
  const CollarPose pose = EstimateCollarPose(*models_[camera], collar_, tags, options, near_T_CE);
  Sight sight;
  sight.tags = tags;
  if (!pose.IsUsable()) return sight;
  sight.source = TrackSource::kCorners;
  sight.T_RE = T_RC * pose.T_CE;
  sight.covariance = Turned(pose.covariance, T_RC.R);
  sight.rms_px = pose.rms_px;
  sight.squared_error_px2 = pose.squared_error_px2;
  sight.dof = pose.dof;
  sight.tags_used = pose.tags_used;
  sight.ambiguous = pose.ambiguous;
  if (pose.alternative) sight.alternative_T_RE = T_RC * *pose.alternative;
  return sight;
}

// A pose from corners as its pixels confirm it. One plane alone may be the other planar pose: it
// counts where it was expected, or where nothing was and no tag is missing.
Sight CollarLocaliser::Acquired(const Images& images, const Sight& corners,
                                const std::optional<Pose>& near_T_RE) {
  if (!corners.Found() || !options_.photometric_fit) return corners;
  Sight sight = Refined(images, corners);
  CheckOtherPlanarPose(images, near_T_RE, sight);
  if (sight.source != TrackSource::kPixels || !sight.pixels.one_plane) return sight;
  const bool believed = near_T_RE ? IsTrusted(sight, *near_T_RE) : IsComplete(sight);
  if (believed) return HeldAgainstCollar(images, std::move(sight));
  Sight nothing;
  nothing.tags = sight.tags;
  return nothing;
}

// What the corners say, made better by the pixels where those agree.
Sight CollarLocaliser::Refined(const Images& images, const Sight& corners) {
  Sight sight = FitCandidates(images, corners);
  if (!sight.Found() && noise_grey_ == 0) {  // nothing fitted yet: the gamma's guess may be wrong
    const std::vector<OpticsPrior> guessed = priors_;
    for (OpticsPrior& prior : priors_) {
      if (prior.gamma_sd > 0) prior.mean.gamma = kLinearGamma;
    }
    sight = FitCandidates(images, corners);
    priors_ = guessed;
  }
  if (!sight.Found()) return corners;
  sight.rms_px = corners.rms_px;
  const std::vector<TagDetection> fitted = std::exchange(sight.tags, corners.tags);
  for (TagDetection& tag : sight.tags) {
    const auto same = std::find_if(fitted.begin(), fitted.end(),
                                   [&](const TagDetection& f) { return f.id == tag.id; });
    if (same == fitted.end()) continue;
    tag.corners_px = same->corners_px;
    tag.refined = true;
  }
  return sight;
}

// The likelier of the fits from the corners' two poses.
Sight CollarLocaliser::FitCandidates(const Images& images, const Sight& corners) {
  Sight sight = FitPixels(images, corners.T_RE);
  if (!corners.alternative_T_RE) return sight;
  const Sight other = FitPixels(images, *corners.alternative_T_RE);
  const bool better =
      other.Found() && (!sight.Found() || LogLikelihoodRatio2(other.pixels, sight.pixels) > 0);
  return better ? other : sight;
}

}  // namespace flextip
