#include "vision/tracking/collar_localiser.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rotation.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kMinSearchCorrelation = 0.35;
constexpr double kAmbiguousRatio = 30.0;     // twice the log of the odds
constexpr double kAmbiguousPerPixel = 0.15;  // log of the ratio of the noises
constexpr double kCornerFallback_px = 0.35;  // what corners alone may be wrong by: gamma, blur
constexpr double kMaxTurn_rad = 0.5, kMaxTurnUnsure_rad = 0.25;  // from one picture to the next
constexpr int kPlanarChecksSpared = 4;
constexpr double kSmallTurn_rad = 0.08;
constexpr double kFirstBlurSd_px2 = 3.0;
constexpr double kLinearGamma = 1.0;  // the second guess where a camera's is not known
constexpr int kDetectMargin_px = 12;
constexpr int kStandingChecksSpared = 4;   // of a tag beside which no other was seen
constexpr double kMaxNeighbour_px = 60.0;  // about where a neighbour should be, it is looked for
constexpr double kContradiction = 6.0;     // standard deviations of two poses from each other

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

// The pose under which a tag, seen as from T_CE, looks nearly the same: turned about its centre so
// that the normal comes to lie on the other side of the line of sight.
Pose OtherPlanarPose(const Pose& T_CE, const Pose& T_EG) {
  const Pose T_CG = T_CE * T_EG;
  const Eigen::Vector3d normal = T_CG.R.col(2), sight = T_CG.p.normalized();
  const Eigen::Vector3d axis = normal.cross(sight);
  const double angle = std::atan2(axis.norm(), normal.dot(sight));
  if (axis.norm() < 1e-6) return T_CE;
  const Pose turned{ExpRotation(2 * angle * axis.normalized()) * T_CG.R, T_CG.p};
  return turned * T_EG.Inverse();
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

std::set<int> CollarLocaliser::FacesOf(const Sight& sight) const {
  std::set<int> ids;
  for (const ViewFit& view : sight.pixels.views) {
    for (const FaceFit& face : view.faces) ids.insert(face.tag_id);
  }
  return ids;
}

// A tag alone fits a picture wherever the collar's file has it. So one that was never fitted
// together with another is looked at beside those that the detector finds, by the same test that
// corners must pass without an expected pose.
Sight CollarLocaliser::HeldAgainstCollar(const Images& images, Sight sight) {
  const std::set<int> faces = FacesOf(sight);
  if (collar_.tags.size() < 2 || faces.size() != 1) return sight;
  const auto tag = std::find_if(collar_.tags.begin(), collar_.tags.end(),
                                [&](const CollarTag& t) { return t.id == *faces.begin(); });
  int& standing = standings_[tag - collar_.tags.begin()];
  if (standing == kAgrees) return sight;
  if (standing_checks_spared_ > 0) {
    --standing_checks_spared_;
  } else {
    standing = Contradicts(images, sight) ? kContradicts : kUnknown;
    standing_checks_spared_ = standing == kContradicts ? 0 : kStandingChecksSpared;
  }
  if (standing != kContradicts) return sight;
  Sight nothing;
  nothing.tags = sight.tags;
  nothing.contradicts_collar = true;
  return nothing;
}

bool CollarLocaliser::Contradicts(const Images& images, const Sight& sight) {
  const std::set<int> faces = FacesOf(sight);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] == nullptr) continue;
    const auto tags = DetectNear(*images[i], i, sight.T_RE, kMaxNeighbour_px);
    const auto shows = [&](bool fitted) {
      return std::any_of(tags.begin(), tags.end(), [&](const TagDetection& t) {
        return faces.contains(t.id) == fitted &&
               std::any_of(collar_.tags.begin(), collar_.tags.end(),
                           [&](const CollarTag& c) { return c.id == t.id; });
      });
    };
    if (!shows(true) || !shows(false)) continue;
    CollarPoseOptions pose = options_.pose;
    pose.corner_noise_floor_px = kCornerFallback_px;
    const Sight corners = FromTags(i, tags, sight.T_RE, pose);
    if (!corners.Found()) return true;
    if (Deviations({sight.T_RE, sight.covariance}, {corners.T_RE, corners.covariance}) >
        kContradiction) {
      return true;
    }
  }
  return false;
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

// Where the other planar pose was clearly worse, it is for some frames: a tip does not jump to it.
bool CollarLocaliser::MaySkipPlanarCheck(const Sight& sight, const Pose& expected_T_RE) {
  const double turn = PoseDifference(expected_T_RE, sight.T_RE).head<3>().norm();
  if (planar_checks_spared_ == 0 || turn > kSmallTurn_rad) return false;
  --planar_checks_spared_;
  return true;
}

// With one plane in view two poses may fit: tries the other, keeps the likelier, and where both
// are nearly as likely takes the one that is expected.
void CollarLocaliser::CheckOtherPlanarPose(const Images& images,
                                           const std::optional<Pose>& near_T_RE, Sight& sight) {
  planar_checks_spared_ = 0;
  if (sight.source != TrackSource::kPixels || !sight.pixels.one_plane) return;
  planar_checks_spared_ = kPlanarChecksSpared;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] == nullptr || sight.pixels.views[i].faces.empty()) continue;
    const auto tag = std::find_if(
        collar_.tags.begin(), collar_.tags.end(),
        [&](const CollarTag& t) { return t.id == sight.pixels.views[i].faces[0].tag_id; });
    const Pose& T_RC = models_[i]->Calibration().T_RC;
    const Pose other = T_RC * OtherPlanarPose(T_RC.Inverse() * sight.T_RE, tag->T_EG);
    Sight second = FitPixels(images, other, true, &sight.pixels);
    if (!second.Found()) return;
    const double apart = PoseDifference(sight.T_RE, second.T_RE).head<3>().norm();
    if (apart < 0.02) return;  // the same minimum
    double ratio = LogLikelihoodRatio2(sight.pixels, second.pixels);
    // Residuals that are not noise (glare, blur) go together: their number proves little.
    const bool unclear = std::abs(ratio) < kAmbiguousRatio ||
                         std::abs(ratio) < 2 * kAmbiguousPerPixel * sight.pixels.pixels;
    bool swap = ratio < 0;
    if (unclear && near_T_RE) {
      swap = PoseDifference(*near_T_RE, second.T_RE).head<3>().norm() <
             PoseDifference(*near_T_RE, sight.T_RE).head<3>().norm();
    }
    if (swap) std::swap(sight, second);
    sight.alternative_T_RE = second.T_RE;
    sight.ambiguous = unclear;
    if (unclear) planar_checks_spared_ = 0;
    if (unclear && !near_T_RE) {
      const Eigen::Matrix<double, 6, 1> difference = PoseDifference(sight.T_RE, second.T_RE);
      sight.covariance += 0.5 * difference * difference.transpose();
    }
    return;
  }
}

}  // namespace flextip
