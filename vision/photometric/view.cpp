#include "vision/photometric/view.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "vision/tags/collar_pose.h"

namespace flextip {
namespace {

constexpr double kFirstScale_grey = 25.0, kMinNoise_grey = 0.7;
constexpr double kSlopeOfContrast = 0.15;  // how much light may change over a face
constexpr double kMinBlur_px2 = 0.01, kMaxBlur_px2 = 60.0;
constexpr double kRim_px = 4.0;     // a tag's surroundings are to be in the picture too
constexpr double kWellSeen = 0.45;  // cosine of 63 degrees
constexpr double kAslant = 0.3;     // cosine of 73 degrees
constexpr double kMaxExtraBlur_cells = 0.3;
constexpr double kNoiseGrowth = 1.005;             // from one picture to the next
constexpr double kSettled = 0.1;                   // of the blur, in one step
constexpr double kBlurChange = 0.4;                // of the blur, from one picture to the next
constexpr double kKnown = 1e-6, kKnown_m = 1e-10;  // standard deviations of what is not fitted

// Pixels this many sigmas from an edge say something; within the lesser reach lie nine tenths of
// what they say of the pose.
constexpr double kReach = 2.9, kLeastReach = 1.4;
constexpr double kDrawnShare = 0.8;  // of the pixels within that reach

using Vector5 = Eigen::Matrix<double, 5, 1>;

}  // namespace

PhotometricView::PhotometricView(const CameraModel& camera, const LensMap& lens,
                                 std::vector<PhotometricFace> faces)
    : camera_(camera), lens_(lens), faces_(std::move(faces)) {}

void PhotometricView::Begin(const Image& image, const Pose& T_CE, const OpticsPrior& prior) {
  image_ = &image;
  prior_ = prior;
  optics_ = prior.mean;
  if (tone_.Gamma() != optics_.gamma) tone_ = ToneCurve(optics_.gamma);
  noise_grey_ = extra_blur_px2_ = 0;
  seen_.clear();
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (faces_[i].IsSeen(camera_, T_CE)) seen_.push_back({i, true, false, {}, {}});
  }
  // A face seen much aslant tells little, and tells it unsurely.
  const bool any = std::any_of(seen_.begin(), seen_.end(), [&](const SeenFace& s) {
    return faces_[s.face].Cosine(T_CE) > kAslant;
  });
  if (any) {
    std::erase_if(seen_, [&](const SeenFace& s) { return faces_[s.face].Cosine(T_CE) < kAslant; });
  }
}

Optics PhotometricView::Widened() const {
  Optics wide = optics_;
  wide.blur_px2 += Eigen::Vector3d(extra_blur_px2_, 0, extra_blur_px2_);
  return wide;
}

// A few pixels lie evenly over all faces. Of many those far from the edges say least: the reach
// shrinks with the budget, then the share within it.
PhotometricFace::Choice PhotometricView::ChoiceOf(const Pose& T_CE, int pixels, bool few,
                                                  double area_px2) const {
  PhotometricFace::Choice choice;
  if (few) {
    choice.stride = std::max(1, static_cast<int>(std::lround(std::sqrt(area_px2 / pixels))));
    return choice;
  }
  double per_sigma = 0;
  for (const SeenFace& s : seen_) {
    if (s.active) per_sigma += faces_[s.face].PixelsPerSigma(camera_, T_CE, Widened());
  }
  per_sigma = std::max(1.0, per_sigma);
  const double reach = std::clamp(pixels / (kDrawnShare * per_sigma), kLeastReach, kReach);
  choice.reach = static_cast<float>(reach);
  choice.share = static_cast<float>(std::min(1.0, pixels / (reach * per_sigma)));
  return choice;
}

void PhotometricView::Select(const Pose& T_CE, int pixels, bool few, double extra_blur_px2,
                             double least_likeness) {
  const double before_px2 = extra_blur_px2_;
  extra_blur_px2_ = extra_blur_px2;
  double area = 0;  // of the seen faces' bounding boxes, roughly
  for (const SeenFace& s : seen_) {
    Eigen::Matrix<double, 2, 3> J;
    const Pose T_CG = T_CE * faces_[s.face].Tag().T_EG;
    if (!s.active || !camera_.Project(T_CG.p, &J)) continue;
    const double side = J(0, 0) * faces_[s.face].Tag().size_m;
    area += side * side * faces_[s.face].Cosine(T_CE);
    const double cell = side * faces_[s.face].CellPart() * faces_[s.face].Cosine(T_CE);
    extra_blur_px2_ = std::min(extra_blur_px2_, std::pow(kMaxExtraBlur_cells * cell, 2));
  }
  if (before_px2 > 0) {  // what was fitted is the blur with the extra
    for (const int i : {0, 2}) {
      optics_.blur_px2[i] =
          std::max(kMinBlur_px2, optics_.blur_px2[i] + before_px2 - extra_blur_px2_);
    }
  }
  const PhotometricFace::Choice choice = ChoiceOf(T_CE, pixels, few, area);
  for (SeenFace& s : seen_) {
    if (!s.active) continue;
    faces_[s.face].SelectPixels(camera_, lens_, *image_, T_CE, Widened(), choice);
    if (!s.has_levels) {
      const double likeness = faces_[s.face].GuessLevels(camera_, T_CE, Widened(), tone_);
      s.has_levels = s.active = likeness > least_likeness;
    }
  }
}

int PhotometricView::Faces() const {
  return static_cast<int>(
      std::count_if(seen_.begin(), seen_.end(), [](const SeenFace& s) { return s.active; }));
}

int PhotometricView::FacesInView(const Pose& T_CE) const {
  const CameraCalibration& c = camera_.Calibration();
  return static_cast<int>(
      std::count_if(faces_.begin(), faces_.end(), [&](const PhotometricFace& face) {
        const CollarTag& tag = face.Tag();
        if (face.Cosine(T_CE) < kWellSeen) return false;
        for (const Eigen::Vector3d& x_E : CornersInE(tag)) {
          const auto px = camera_.Project(T_CE * x_E);
          const bool inside = px && px->x() >= kRim_px && px->y() >= kRim_px &&
                              px->x() <= c.width_px - 1 - kRim_px &&
                              px->y() <= c.height_px - 1 - kRim_px;
          if (!inside) return false;
        }
        return true;
      }));
}

std::vector<FaceFit> PhotometricView::FaceFits() const {
  std::vector<FaceFit> fits;
  for (const SeenFace& s : seen_) {
    if (!s.active) continue;
    const FaceLevels& level = faces_[s.face].levels;
    const double contrast =
        tone_.At(static_cast<float>(level[3])).grey - tone_.At(static_cast<float>(level[0])).grey;
    const int pixels = s.sums.Pixels();
    fits.push_back({faces_[s.face].Tag().id, pixels, s.sums.Weight() / std::max(1, pixels),
                    s.sums.Correlation(), contrast, s.sums.Contradicted()});
  }
  return fits;
}

int PhotometricView::DropFaces(double min_correlation, double min_contrast,
                               double max_contradicted) {
  std::size_t at = 0;
  const auto fits = FaceFits();
  for (SeenFace& s : seen_) {
    if (!s.active) continue;
    const FaceFit& fit = fits[at++];
    s.active = fit.correlation >= min_correlation && fit.contrast >= min_contrast &&
               fit.contradicted <= max_contradicted;
  }
  return Faces();
}

std::vector<Eigen::Vector3d> PhotometricView::Normals() const {
  std::vector<Eigen::Vector3d> normals;
  for (const SeenFace& s : seen_) {
    if (s.active) normals.emplace_back(-faces_[s.face].Tag().T_EG.R.col(2));
  }
  return normals;
}

// Learns the noise from the median size of the residuals.
void PhotometricView::LearnNoise() {
  FaceSums::Histogram errors{};
  int count = 0, below = 0;
  for (const SeenFace& s : seen_) {
    if (!s.active) continue;
    s.sums.AddErrorsTo(errors);
    count += s.sums.Pixels();
  }
  if (count == 0) return;
  int bin = 0;
  while (2 * (below + errors[bin]) < count) below += errors[bin++];
  const double within = (0.5 * count - below) / std::max(1, errors[bin]);
  noise_grey_ = std::max(kMinNoise_grey, 1.4826 * (bin + within) / FaceSums::kBinsPerGrey);
}

PoseTerm PhotometricView::Linearise(const Pose& T_CE, Robustness kind) {
  const bool known = noise_grey_ > 0;
  if (!known) kind = Robustness::kHuber;
  const double wider = kind == Robustness::kHuber ? 1.5 : 1.0;
  const RobustRule rule(known ? wider * noise_grey_ : kFirstScale_grey, kind);
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  for (const SeenFace& s : seen_) pivot += T_CE * faces_[s.face].Tag().T_EG.p;
  if (!seen_.empty()) pivot /= static_cast<double>(seen_.size());
  // About the pivot dc = dp - dw x (p - pivot).
  to_pivot_.bottomLeftCorner<3, 3>() = Skew(T_CE.p - pivot);

  Matrix11 A = Matrix11::Zero();
  Vector11 b = Vector11::Zero();
  PoseTerm totals;
  for (SeenFace& s : seen_) {
    if (!s.active) continue;
    s.sums = FaceSums();
    faces_[s.face].Accumulate(camera_, T_CE, pivot, Widened(), tone_, rule, s.sums);
    EliminateLevels(s, A, b);
    totals.weight += s.sums.Weight();
    totals.pixels += s.sums.Pixels();
  }
  LearnNoise();
  PoseTerm term = EliminateOptics(A, b);
  term.weight = totals.weight;
  term.pixels = totals.pixels;
  return term;
}

Eigen::Matrix<double, 6, 6> PhotometricView::ScoreScatter(double& white) const {
  double squares = 0, curvature = 0;
  std::vector<Eigen::Matrix<double, 6, 1>> scores;
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  for (const SeenFace& s : seen_) {
    if (!s.active) continue;
    squares += s.sums.WeightedSquares();
    curvature += s.sums.Curvature();
    for (int i = 0; i < FaceSums::kPatches; ++i) {
      const Eigen::Matrix<double, FaceColumns::kResidual, 1> all = s.sums.PatchScores().col(i);
      const Vector11 rest = all.head<11>() - s.levels.by_rest.transpose() * all.tail<6>();
      const Eigen::Matrix<double, 6, 1> pose =
          rest.head<6>() - optics_elimination_.by_rest.transpose() * rest.tail<5>();
      scores.emplace_back(to_pivot_.transpose() * pose);
      mean += scores.back();
    }
  }
  Eigen::Matrix<double, 6, 6> scatter = Eigen::Matrix<double, 6, 6>::Zero();
  if (scores.empty() || curvature <= 0) return scatter;
  mean /= static_cast<double>(scores.size());
  for (const auto& score : scores) scatter += (score - mean) * (score - mean).transpose();
  white = squares / (curvature * std::pow(std::max(noise_grey_, kMinNoise_grey), 2));
  return scatter;
}

void PhotometricView::EliminateLevels(SeenFace& s, Matrix11& A, Vector11& b) const {
  constexpr int kL = FaceColumns::kLevels, kR = FaceColumns::kResidual;
  const FaceLevels& level = faces_[s.face].levels;
  Eigen::Matrix<double, 6, 6> H = s.sums.A().block<6, 6>(kL, kL);
  Eigen::Matrix<double, 6, 1> r = s.sums.A().block<6, 1>(kL, kR);
  const double noise2 = std::pow(std::max(noise_grey_, kMinNoise_grey), 2);
  const double slope = kSlopeOfContrast * std::max(0.02, level[3]);
  for (const int i : {1, 2, 4, 5}) {
    H(i, i) += noise2 / (slope * slope);
    r[i] -= noise2 / (slope * slope) * level[i];
  }
  for (const int i : {0, 3}) H(i, i) += 1e-3 * noise2;
  const Eigen::Matrix<double, 6, 11> C = s.sums.A().block<6, 11>(kL, 0);
  const Ldlt solver(H);
  s.levels.constant = solver.Solve(r);
  s.levels.by_rest = solver.Solve(C);
  A += s.sums.A().topLeftCorner<11, 11>() - C.transpose() * s.levels.by_rest;
  b += s.sums.A().block<11, 1>(0, kR) - C.transpose() * s.levels.constant;
}

PoseTerm PhotometricView::EliminateOptics(Matrix11 A, Vector11 b) {
  const double noise2 = std::pow(std::max(noise_grey_, kMinNoise_grey), 2);
  const double gamma_sd = prior_.gamma_sd > 0 ? prior_.gamma_sd : kKnown;
  const double offset_sd = prior_.print_offset_sd_m > 0 ? prior_.print_offset_sd_m : kKnown_m;
  Vector5 sd, off;
  sd << prior_.blur_sd_px2, 0.5 * prior_.blur_sd_px2, prior_.blur_sd_px2, gamma_sd, offset_sd;
  off << optics_.blur_px2 - prior_.mean.blur_px2, optics_.gamma - prior_.mean.gamma,
      optics_.print_offset_m - prior_.mean.print_offset_m;
  for (int i = 0; i < 5; ++i) {
    A(6 + i, 6 + i) += noise2 / (sd[i] * sd[i]);
    b[6 + i] -= noise2 / (sd[i] * sd[i]) * off[i];
  }
  const Ldlt solver(A.bottomRightCorner<5, 5>());
  const Eigen::Matrix<double, 5, 6> C = A.bottomLeftCorner<5, 6>();
  optics_elimination_.constant = solver.Solve(b.tail<5>());
  optics_elimination_.by_rest = solver.Solve(C);
  optics_variance_ = noise2 * solver.Inverse().diagonal();
  const Eigen::Matrix<double, 6, 6> JtJ =
      A.topLeftCorner<6, 6>() - C.transpose() * optics_elimination_.by_rest;
  const Eigen::Matrix<double, 6, 1> Jtr =
      b.head<6>() - C.transpose() * optics_elimination_.constant;
  PoseTerm term;
  term.JtJ = to_pivot_.transpose() * JtJ * to_pivot_;
  term.Jtr = to_pivot_.transpose() * Jtr;
  return term;
}

bool PhotometricView::Step(const Eigen::Matrix<double, 6, 1>& step) {
  Vector11 rest;
  rest.head<6>() = to_pivot_ * step;
  rest.tail<5>() = optics_elimination_.constant - optics_elimination_.by_rest * rest.head<6>();
  const double limit = std::max(0.3, 0.7 * std::max(optics_.blur_px2[0], optics_.blur_px2[2]));
  const Eigen::Vector3d moved =
      optics_.blur_px2 + rest.segment<3>(6).cwiseMax(-limit).cwiseMin(limit);
  const double xx = std::clamp(moved[0], kMinBlur_px2, kMaxBlur_px2);
  const double yy = std::clamp(moved[2], kMinBlur_px2, kMaxBlur_px2);
  const double most = 0.95 * std::sqrt(xx * yy);
  const double changed = std::abs(xx - optics_.blur_px2[0]) + std::abs(yy - optics_.blur_px2[2]);
  const bool settled = changed < kSettled * (xx + yy);
  optics_.blur_px2 = {xx, std::clamp(moved[1], -most, most), yy};
  if (prior_.gamma_sd > 0) {
    optics_.gamma = std::clamp(optics_.gamma + rest[9], 0.7, 3.5);
    tone_ = ToneCurve(optics_.gamma);
  }
  optics_.print_offset_m += rest[10];
  for (SeenFace& s : seen_) {
    if (s.active) faces_[s.face].levels += s.levels.constant - s.levels.by_rest * rest;
  }
  return settled;
}

OpticsPrior PhotometricView::Learned(const Eigen::Matrix<double, 6, 6>& covariance) const {
  const Eigen::Matrix<double, 5, 6> by_pose = optics_elimination_.by_rest * to_pivot_;
  const Vector5 sd =
      (optics_variance_ + (by_pose * covariance * by_pose.transpose()).diagonal()).cwiseSqrt();
  OpticsPrior next = prior_;
  next.mean = optics_;
  // The least noise seen so far, which may grow slowly.
  next.noise_grey =
      prior_.noise_grey > 0 ? std::min(noise_grey_, kNoiseGrowth * prior_.noise_grey) : noise_grey_;
  next.blur_sd_px2 = kBlurChange * (optics_.blur_px2[0] + optics_.blur_px2[2]) + 0.1;
  if (prior_.gamma_sd > 0) next.gamma_sd = std::min(prior_.gamma_sd, std::max(0.003, sd[3]));
  if (prior_.print_offset_sd_m > 0) {
    next.print_offset_sd_m = std::min(prior_.print_offset_sd_m, std::max(5e-7, sd[4]));
  }
  return next;
}

double PhotometricView::ExcessNoisePx() const {
  if (prior_.noise_grey <= 0 || noise_grey_ <= prior_.noise_grey) return 0.0;
  double contrast = 0;
  for (const FaceFit& face : FaceFits()) contrast = std::max(contrast, face.contrast);
  const double excess_grey = std::sqrt(std::pow(noise_grey_, 2) - std::pow(prior_.noise_grey, 2));
  const double width_px =
      std::sqrt(2 * M_PI * (0.5 * (optics_.blur_px2[0] + optics_.blur_px2[2]) + 1.0 / 12));
  return excess_grey * width_px / std::max(1.0, contrast);
}

std::vector<Eigen::Vector3d> PhotometricView::Corners() const {
  std::vector<Eigen::Vector3d> corners;
  for (const SeenFace& s : seen_) {
    if (!s.active) continue;
    const auto of_face = CornersInE(faces_[s.face].Tag());
    corners.insert(corners.end(), of_face.begin(), of_face.end());
  }
  return corners;
}

}  // namespace flextip
