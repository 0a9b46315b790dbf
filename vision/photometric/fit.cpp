#include "vision/photometric/fit.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "vision/tags/collar_faces.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// A stage ends with a step below this many pixels; the last stage ends with a step whose square is
// below this many of its own variances.
constexpr double kCoarseStep_px = 0.8, kFineStep_px = 0.25, kLastStep_px = 0.05;
constexpr double kClearScatter = 2.0;   // over that of noise, which 32 patches seldom reach
constexpr double kLeastLikeness = 0.4;  // of a tag that is within reach
constexpr double kLastStep = 1.0, kGoodStep = 3.0;  // the second: where the iterations run out
constexpr double kNear_px = 6.0, kNearPart = 0.03, kNear_rad = 0.12;
constexpr double kMaxTurn_rad = 0.2;
constexpr double kWorseNoise = 1.6, kWorseNoise_grey = 0.5;  // few pixels tell noise to some 5 %
constexpr double kParallel = 0.985;                          // cosine of 10 degrees

struct Camera {
  explicit Camera(const CameraCalibration& calibration)
      : model(calibration), lens(model), T_CR(calibration.T_RC.Inverse()) {}
  CameraModel model;
  LensMap lens;
  Pose T_CR;
};

}  // namespace

struct PhotometricFit::Impl {
  PhotometricOptions options;
  std::vector<std::unique_ptr<Camera>> cameras;
  std::vector<PhotometricView> views;
  std::vector<bool> present;
  std::vector<Eigen::Vector3d> points_E;  // of the collar

  struct Sums {
    Matrix6 JtJ = Matrix6::Zero();
    Vector6 Jtr = Vector6::Zero();
    double weight = 0;
    int pixels = 0;
  };

  void Begin(const std::vector<const Image*>& images, const Pose& T_RE,
             const std::vector<OpticsPrior>& priors) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      present[i] = i < images.size() && images[i] != nullptr && !images[i]->Empty();
      if (present[i]) views[i].Begin(*images[i], cameras[i]->T_CR * T_RE, priors.at(i));
    }
  }

  void Select(const Pose& T_RE, int pixels, bool few, double extra_blur_px2,
              double least_likeness = 0) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!present[i]) continue;
      views[i].Select(cameras[i]->T_CR * T_RE, pixels, few, extra_blur_px2, least_likeness);
    }
  }

  int Faces() const {
    int faces = 0;
    for (std::size_t i = 0; i < views.size(); ++i) faces += present[i] ? views[i].Faces() : 0;
    return faces;
  }

  void DropFaces(double correlation, double contradicted) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (present[i]) views[i].DropFaces(correlation, options.min_contrast_grey, contradicted);
    }
  }

  Sums Linearise(const Pose& T_RE, Robustness kind) {
    Sums sums;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!present[i] || views[i].Faces() == 0) continue;
      const PoseTerm term = views[i].Linearise(cameras[i]->T_CR * T_RE, kind);
      const double variance = std::pow(std::max(views[i].NoiseGrey(), 0.5), 2);
      const Eigen::Matrix3d R_RC = cameras[i]->T_CR.R.transpose();
      sums.JtJ += Turned(term.JtJ, R_RC) / variance;
      sums.Jtr += Turned(term.Jtr, R_RC) / variance;
      sums.weight += term.weight;
      sums.pixels += term.pixels;
    }
    return sums;
  }

  // Returns false where a picture's blur is not settled yet.
  bool Step(const Vector6& step_R) {
    bool settled = true;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!present[i] || views[i].Faces() == 0) continue;
      settled = views[i].Step(Turned(step_R, cameras[i]->T_CR.R)) && settled;
    }
    return settled;
  }

  // Returns the motion of the collar in the pictures when E goes from one pose to the other (px).
  double MovedPx(const Pose& from_T_RE, const Pose& to_T_RE) const {
    double most = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      for (const Eigen::Vector3d& x_E : points_E) {
        const auto a = cameras[i]->model.Project(cameras[i]->T_CR * (from_T_RE * x_E));
        const auto b = cameras[i]->model.Project(cameras[i]->T_CR * (to_T_RE * x_E));
        if (present[i] && a && b) most = std::max(most, (*a - *b).norm());
      }
    }
    return most;
  }

  // Keeps the first stages near their start, since they see few pixels through a wide blur: by some
  // pixels across, and in proportion along the line of sight and in rotation.
  Matrix6 StayNear(const Pose& T_RE) const {
    Eigen::Vector3d centre_E = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x_E : points_E) centre_E += x_E;
    centre_E /= static_cast<double>(points_E.size());
    const Camera& camera = *cameras[0];
    const double z = std::max(0.01, (camera.T_CR * (T_RE * centre_E)).z());
    const double across = kNear_px * z / camera.model.Calibration().fu_px;
    const Eigen::Matrix3d R_RC = camera.T_CR.R.transpose();
    const Eigen::Vector3d sd(across, across, kNearPart * z);
    Matrix6 about_centre = Matrix6::Zero();
    about_centre.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / (kNear_rad * kNear_rad);
    about_centre.bottomRightCorner<3, 3>() =
        R_RC * sd.cwiseAbs2().cwiseInverse().asDiagonal() * R_RC.transpose();
    Matrix6 to_centre = Matrix6::Identity();
    to_centre.bottomLeftCorner<3, 3>() = -Skew(T_RE.R * centre_E);
    return to_centre.transpose() * about_centre * to_centre;
  }

  // Makes Gauss-Newton steps until a step is small.
  bool Iterate(Pose& T_RE, Sums& sums, int max_iterations, double small_px, Robustness kind,
               const Matrix6& near_start = Matrix6::Zero()) {
    const Pose start = T_RE;
    double last_size = HUGE_VAL;
    for (int i = 0; i < max_iterations; ++i) {
      sums = Linearise(T_RE, kind);
      if (sums.pixels == 0) return false;
      const Vector6 gone = PoseDifference(start, T_RE);
      Vector6 step = Ldlt(sums.JtJ + near_start).Solve(sums.Jtr - near_start * gone);
      if (!step.allFinite()) return false;
      const double size = step.dot(sums.JtJ * step);
      const double turn = step.head<3>().norm();
      if (turn > kMaxTurn_rad) step *= kMaxTurn_rad / turn;
      const Pose moved = MovePose(T_RE, step);
      const double moved_px = MovedPx(T_RE, moved);
      T_RE = moved;
      const bool settled = Step(step);
      last_size = size;
      const bool robust = kind != Robustness::kHuber;
      const bool small = moved_px < small_px || (robust && size < kLastStep);
      if (small && (settled || !robust)) return true;
    }
    return last_size < kGoodStep;
  }

  // Whether the last pixels leave far more noise than a rival's in a picture.
  bool IsClearlyWorse(const PhotometricResult& rival) const {
    for (std::size_t i = 0; i < views.size(); ++i) {
      const double noise_grey = rival.views[i].noise_grey;
      if (present[i] && noise_grey > 0 &&
          views[i].NoiseGrey() > kWorseNoise * noise_grey + kWorseNoise_grey) {
        return true;
      }
    }
    return false;
  }

  bool OnePlane() const {
    std::vector<Eigen::Vector3d> all;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!present[i]) continue;
      const auto normals = views[i].Normals();
      all.insert(all.end(), normals.begin(), normals.end());
    }
    return std::all_of(all.begin(), all.end(),
                       [&](const Eigen::Vector3d& n) { return n.dot(all[0]) > kParallel; });
  }

  Matrix6 ResidualCovariance(const Matrix6& JtJ) const;
  Matrix6 ModelCovariance(const Pose& T_RE) const;
  PhotometricResult Report(const Pose& T_RE, const Sums& sums, bool converged) const;
};

// Returns the covariance by the sandwich of M-estimators. The gradient's scatter over patches of
// the tags stands for the noise where it clearly exceeds that of independent pixels (glare, smoke,
// dirt, a wrong pattern).
Matrix6 PhotometricFit::Impl::ResidualCovariance(const Matrix6& JtJ) const {
  Matrix6 scatter = Matrix6::Zero();
  double white = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!present[i] || views[i].Faces() == 0) continue;
    const double variance = std::pow(std::max(views[i].NoiseGrey(), 0.5), 2);
    double of_view = 1;
    scatter += Turned(views[i].ScoreScatter(of_view), cameras[i]->T_CR.R.transpose()) /
               (variance * variance);
    white = std::max(white, of_view);
  }
  const Llt root(JtJ);
  const Matrix6 half = root.SolveL(scatter);
  const SymmetricEigen axes(root.SolveL(half.transpose()));
  Vector6 noise = axes.values;
  for (double& n : noise) n = n > kClearScatter * white ? n : white;
  const Matrix6 out = root.SolveLTransposed(axes.vectors);
  return out * noise.asDiagonal() * out.transpose();
}

// Returns the covariance of the pose as if the corners of all tags were measured with the model's
// noise.
Matrix6 PhotometricFit::Impl::ModelCovariance(const Pose& T_RE) const {
  Matrix6 information = Matrix6::Zero();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!present[i]) continue;
    std::vector<Correspondence> corners;
    for (const Eigen::Vector3d& x_E : views[i].Corners()) corners.push_back({x_E, {0, 0}});
    const auto sum = Reproject(cameras[i]->model, corners, cameras[i]->T_CR * T_RE);
    const double noise_px = options.model_noise_px + views[i].ExcessNoisePx();
    if (sum && noise_px > 0) {
      information += Turned(sum->JtJ, cameras[i]->T_CR.R.transpose()) / (noise_px * noise_px);
    }
  }
  if (information.isZero()) return Matrix6::Zero();
  return Ldlt(information).Inverse();
}

PhotometricResult PhotometricFit::Impl::Report(const Pose& T_RE, const Sums& sums,
                                               bool converged) const {
  PhotometricResult result;
  result.T_RE = T_RE;
  result.pixels = sums.pixels;
  result.faces = Faces();
  result.one_plane = OnePlane();
  const bool solvable = Ldlt(sums.JtJ).IsPositive();
  const Matrix6 covariance = solvable ? ResidualCovariance(sums.JtJ) : Matrix6::Zero();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (present[i]) result.faces_in_view += views[i].FacesInView(cameras[i]->T_CR * T_RE);
    ViewFit fit;
    if (present[i]) {
      fit = {views[i].Learned(Turned(covariance, cameras[i]->T_CR.R)), views[i].NoiseGrey(),
             views[i].FaceFits()};
    }
    result.views.push_back(fit);
  }
  result.covariance = covariance + ModelCovariance(T_RE);
  if (!converged || !solvable || !result.covariance.allFinite()) {
    result.status = PhotometricStatus::kNotConverged;
  } else if (sums.weight < options.min_inliers * sums.pixels) {
    result.status = PhotometricStatus::kPoorFit;
  } else {
    result.status = PhotometricStatus::kOk;
  }
  return result;
}

double LogLikelihoodRatio2(const PhotometricResult& a, const PhotometricResult& b) {
  double ratio = 0;
  for (std::size_t i = 0; i < std::min(a.views.size(), b.views.size()); ++i) {
    if (a.views[i].noise_grey <= 0 || b.views[i].noise_grey <= 0) continue;
    int pixels = 0;
    for (const FaceFit& face : a.views[i].faces) pixels += face.pixels;
    ratio += 2 * pixels * std::log(b.views[i].noise_grey / a.views[i].noise_grey);
  }
  return ratio;
}

PhotometricFit::PhotometricFit(const std::vector<CameraCalibration>& cameras,
                               const TagCollar& collar, const PhotometricOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  const std::vector<PhotometricFace> faces = MakeFaces(collar);
  for (const CameraCalibration& camera : cameras) {
    impl_->cameras.push_back(std::make_unique<Camera>(camera));
    impl_->views.emplace_back(impl_->cameras.back()->model, impl_->cameras.back()->lens, faces);
  }
  for (const CollarTag& tag : collar.tags) {
    impl_->points_E.push_back(tag.T_EG * Eigen::Vector3d(0.5 * tag.size_m, 0.5 * tag.size_m, 0));
    impl_->points_E.push_back(tag.T_EG * Eigen::Vector3d(-0.5 * tag.size_m, -0.5 * tag.size_m, 0));
  }
  impl_->present.assign(cameras.size(), false);
}
PhotometricFit::~PhotometricFit() = default;
PhotometricFit::PhotometricFit(PhotometricFit&&) noexcept = default;
PhotometricFit& PhotometricFit::operator=(PhotometricFit&&) noexcept = default;

PhotometricResult PhotometricFit::Fit(const std::vector<const Image*>& images,
                                      const Pose& start_T_RE,
                                      const std::vector<OpticsPrior>& priors, bool coarse,
                                      const PhotometricResult* rival) {
  Impl& f = *impl_;
  const PhotometricOptions& o = f.options;
  Pose T_RE = start_T_RE;
  Impl::Sums sums;
  f.Begin(images, T_RE, priors);
  if (f.Faces() == 0) return {};
  if (coarse) {
    f.Select(T_RE, o.coarse_pixels, true, o.coarse_extra_blur_px2);
    f.Iterate(T_RE, sums, o.max_coarse_iterations, kCoarseStep_px, Robustness::kHuber,
              f.StayNear(T_RE));
  }
  f.Select(T_RE, o.coarse_pixels, true, 0, kLeastLikeness);  // after the coarse steps all are known
  if (f.Faces() == 0) return {};
  f.Iterate(T_RE, sums, o.max_coarse_iterations, kFineStep_px, Robustness::kTukey,
            f.StayNear(T_RE));
  f.DropFaces(0.6 * o.min_correlation, 1);
  if (f.Faces() == 0) return {};
  PhotometricResult poor;
  poor.status = PhotometricStatus::kPoorFit;
  if (rival != nullptr && f.IsClearlyWorse(*rival)) return poor;
  f.Select(T_RE, o.max_pixels, false, 0);
  bool converged = f.Iterate(T_RE, sums, o.max_iterations, kLastStep_px, Robustness::kTukeyNewton);
  const int faces = f.Faces();
  f.DropFaces(o.min_correlation, o.max_contradicted);
  if (f.Faces() == 0) return poor;
  if (f.Faces() < faces)
    converged = f.Iterate(T_RE, sums, o.max_iterations, kLastStep_px, Robustness::kTukeyNewton);
  return f.Report(T_RE, sums, converged);
}

}  // namespace flextip
