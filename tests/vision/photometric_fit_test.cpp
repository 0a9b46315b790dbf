// The photometric fit on rendered frames beside the truth.
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "vision/photometric/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/rotation.h"
#include "tests/vision/scope_scene.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

OpticsPrior KnownGamma() {
  OpticsPrior prior;
  prior.mean.gamma = 2.2;
  prior.blur_sd_px2 = 3.0;
  return prior;
}

double Nees(const PhotometricResult& fit, const Pose& T_RE) {
  const Vector6 e = PoseDifference(fit.T_RE, T_RE);
  return MahalanobisSquared(e, fit.covariance);
}

struct Scatter {
  double nees = 0, bias_nees = 0, bias_mm = 0, rms_mm = 0, noise_grey = 0, gamma = 0, gamma_sd = 0;
  int ok = 0;
};

// Frames of one pose that differ by their noise. `bias_nees`: the mean error, squared, over the
// mean covariance; 6 / frames where it is nothing but noise.
Scatter Scattered(const simulation::LinearImage& light, double gamma, const Pose& T_RE,
                  PhotometricFit& fit, const OpticsPrior& prior, int frames) {
  Scatter s;
  Vector6 mean = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
  double squared = 0;
  for (int i = 0; i < frames; ++i) {
    const Image image = Film(light, gamma, static_cast<unsigned>(100 + i));
    const PhotometricResult r = fit.Fit({&image}, T_RE, {prior});
    s.ok += r.IsUsable();
    const Vector6 e = PoseDifference(T_RE, r.T_RE);
    mean += e / frames;
    squared += e.tail<3>().squaredNorm() / frames;
    covariance += r.covariance / frames;
    s.nees += Nees(r, T_RE) / frames;
    if (r.views.empty()) continue;
    s.noise_grey += r.views[0].noise_grey / frames;
    s.gamma += r.views[0].learned.mean.gamma / frames;
    s.gamma_sd += r.views[0].learned.gamma_sd / frames;
  }
  s.bias_nees = MahalanobisSquared(mean, covariance);
  s.bias_mm = 1e3 * mean.tail<3>().norm();
  s.rms_mm = 1e3 * std::sqrt(squared);
  return s;
}

PhotometricOptions OnlyNoise() {
  PhotometricOptions options;
  options.model_noise_px = 0;
  return options;
}

constexpr double kBlur_px = 0.7;

// The mean of 60 values of chi-square 6 is 6 +- 0.45.
TEST(PhotometricFit, CovarianceIsThatOfTheScatter) {
  constexpr int kFrames = 60;
  const CameraCalibration camera = ScopeCamera();
  for (const auto& [lean, roll] : {std::pair{0.1, 0.25}, {-0.5, 0.1}}) {
    const Pose T_RE = ScopePose(lean, roll);
    const simulation::LinearImage light = LightThroughLens(camera, ScopeCollar(), T_RE, kBlur_px);
    PhotometricFit fit({camera}, ScopeCollar(), OnlyNoise());
    const Scatter s = Scattered(light, 2.2, T_RE, fit, KnownGamma(), kFrames);
    EXPECT_EQ(s.ok, kFrames);
    EXPECT_NEAR(s.nees, 6, 1.5) << lean;
    EXPECT_LT(s.bias_nees, 1.2) << lean;  // a fifth of what the covariance says of one frame
    EXPECT_LT(s.bias_mm, 0.01) << lean;
    EXPECT_LT(s.rms_mm, 0.015) << lean;
  }
}

// A blur of many pixels spreads the light's slope and is not the same all over a tag: 12 of 6
// where the model does not know of both.
TEST(PhotometricFit, AWideBlurLeavesNoBias) {
  constexpr int kFrames = 40;
  const CameraCalibration camera = ScopeCamera();
  for (const double lean : {-0.5, 0.1, 0.3}) {
    const Pose T_RE = ScopePose(lean, 0.25);
    const simulation::LinearImage light = LightThroughLens(camera, ScopeCollar(), T_RE, 1.6);
    PhotometricFit fit({camera}, ScopeCollar(), OnlyNoise());
    const Scatter s = Scattered(light, 2.2, T_RE, fit, KnownGamma(), kFrames);
    EXPECT_EQ(s.ok, kFrames);
    EXPECT_NEAR(s.nees, 6, 2) << lean;
    EXPECT_LT(s.bias_nees, 1.5) << lean;
  }
}

// Light and dark patches some pixels wide over the picture, as of glare and smoke: residuals that
// go together say less than their number.
Image Patchy(Image image, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(0, image.width_px), y(0, image.height_px);
  std::normal_distribution<double> height(0, 4);
  std::vector<double> field(image.data.size());
  constexpr int kWidth_px = 4, kReach_px = 3 * kWidth_px;
  for (int patch = 0; patch < 1500; ++patch) {
    const int u = static_cast<int>(x(random)), v = static_cast<int>(y(random));
    const double h = height(random);
    for (int j = std::max(0, v - kReach_px); j < std::min(image.height_px, v + kReach_px); ++j) {
      for (int i = std::max(0, u - kReach_px); i < std::min(image.width_px, u + kReach_px); ++i) {
        const double r2 = (i - u) * (i - u) + (j - v) * (j - v);
        field[static_cast<std::size_t>(j) * image.width_px + i] +=
            h * std::exp(-r2 / (2.0 * kWidth_px * kWidth_px));
      }
    }
  }
  for (std::size_t i = 0; i < field.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(std::clamp(image.data[i] + field[i], 0.0, 255.0));
  }
  return image;
}

TEST(PhotometricFit, CovarianceKnowsOfResidualsThatGoTogether) {
  constexpr int kFrames = 40;
  const Pose T_RE = ScopePose(0.1, 0.25);
  const CameraCalibration camera = ScopeCamera();
  const simulation::LinearImage light = LightThroughLens(camera, ScopeCollar(), T_RE, kBlur_px);
  PhotometricFit fit({camera}, ScopeCollar(), OnlyNoise());
  double nees = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Image image = Patchy(Film(light, 2.2, 300u + i), 500u + i);
    const PhotometricResult r = fit.Fit({&image}, T_RE, {KnownGamma()});
    ASSERT_TRUE(r.IsUsable()) << i;
    nees += Nees(r, T_RE) / kFrames;
  }
  // 6 is what it should be; by the number of the pixels alone it comes to 69.
  EXPECT_LT(nees, 4 * 6);
  EXPECT_GT(nees, 2);
}

TEST(PhotometricFit, FindsTheGamma) {
  constexpr int kFrames = 40;
  const Pose T_RE = ScopePose(0.4, 0.5);
  const simulation::LinearImage light =
      LightThroughLens(ScopeCamera(), ScopeCollar(), T_RE, kBlur_px);
  PhotometricFit fit({ScopeCamera()}, ScopeCollar(), OnlyNoise());
  OpticsPrior prior = KnownGamma();
  prior.gamma_sd = 0.4;
  const Scatter s = Scattered(light, 1.8, T_RE, fit, prior, kFrames);
  EXPECT_EQ(s.ok, kFrames);
  EXPECT_NEAR(s.gamma, 1.8, s.gamma_sd);
  EXPECT_LT(s.gamma_sd, 0.01);
  EXPECT_NEAR(s.nees, 6, 1.9);
  EXPECT_LT(s.bias_mm, 0.01);
}

const Pose kSeen = ScopePose(0.1, 0.25);

Image Frame(const CameraCalibration& camera, const TagCollar& collar, const Pose& T_RE,
            const std::function<void(simulation::LaparoscopeOptions&)>& change = {}) {
  simulation::LaparoscopeOptions options = ScopeOptions(ScopeCamera());
  if (change) change(options);
  return simulation::Laparoscope(camera, collar, options).Render(ScopeShaft(T_RE), 0);
}

// A pose from which the tags are seen `shift_px` away and turned by `turn_deg`.
Pose Off(double shift_px, double turn_deg, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Vector3d axis = DrawVector<3>(normal, random).normalized();
  const double angle = 2 * M_PI * std::uniform_real_distribution<double>()(random);
  const CameraCalibration camera = ScopeCamera();
  const Pose T_CR = camera.T_RC.Inverse();
  Pose T_CE = T_CR * kSeen;
  const Eigen::Vector3d centre = T_CE * Eigen::Vector3d(-0.015, 0, 0);
  const Eigen::Vector3d shift =
      shift_px * centre.z() / camera.fu_px * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  const Eigen::Matrix3d turn = ExpRotation(turn_deg * M_PI / 180 * axis);
  T_CE = {turn * T_CE.R, turn * (T_CE.p - centre) + centre + shift};
  return camera.T_RC * T_CE;
}

// A cell is 3.7 px wide. Where a fit ends elsewhere it says so, or that one plane is all it has
// (which two poses may share; the tracker tries both).
TEST(PhotometricFit, StartsSomePixelsOffConverge) {
  const CameraCalibration camera = ScopeCamera();
  const Image image = Frame(camera, ScopeCollar(), kSeen);
  PhotometricFit fit({camera}, ScopeCollar());
  std::mt19937 random(1);
  for (const auto& [shift_px, at_least] : {std::pair{1.0, 15}, {2.0, 14}, {3.0, 11}, {4.0, 9}}) {
    int converged = 0;
    for (int i = 0; i < 15; ++i) {
      const PhotometricResult r = fit.Fit({&image}, Off(shift_px, 3, random), {KnownGamma()});
      if (!r.IsUsable()) continue;
      const bool right = Nees(r, kSeen) < 22.5;
      converged += right;
      EXPECT_TRUE(right || r.one_plane) << shift_px;
    }
    EXPECT_GE(converged, at_least) << shift_px;
  }
}

TEST(PhotometricFit, AStartOnTheWrongPlaceIsNotOk) {
  const CameraCalibration camera = ScopeCamera();
  const Image image = Frame(camera, ScopeCollar(), kSeen);
  PhotometricFit fit({camera}, ScopeCollar());
  std::mt19937 random(2);
  for (const double shift_px : {12.0, 20.0, 40.0, 70.0}) {
    for (int i = 0; i < 12; ++i) {
      const PhotometricResult r = fit.Fit({&image}, Off(shift_px, 2, random), {KnownGamma()});
      EXPECT_TRUE(!r.IsUsable() || PoseDifference(r.T_RE, kSeen).tail<3>().norm() < 1e-4)
          << shift_px;
    }
  }
}

TEST(PhotometricFit, ATagHalfCoveredDoesNotMoveThePose) {
  const CameraCalibration camera = ScopeCamera();
  const auto cover = [](simulation::LaparoscopeOptions& o) {
    simulation::Stain stain;
    stain.tag_id = 0;
    stain.centre_m = {0.0025, 0.0};
    stain.radius_m = 0.0025;
    o.hazards.stains.push_back(stain);
  };
  const Image clear = Frame(camera, ScopeCollar(), kSeen),
              covered = Frame(camera, ScopeCollar(), kSeen, cover);
  PhotometricFit fit({camera}, ScopeCollar());
  const PhotometricResult a = fit.Fit({&clear}, kSeen, {KnownGamma()});
  const PhotometricResult b = fit.Fit({&covered}, kSeen, {KnownGamma()});
  ASSERT_TRUE(a.IsUsable());
  ASSERT_TRUE(b.IsUsable());
  for (const FaceFit& face : b.views[0].faces) EXPECT_LT(face.contradicted, 0.005);
  EXPECT_LT(Nees(a, kSeen), 22.5);  // 99.9 % of chi-square 6
  EXPECT_LT(PoseDifference(b.T_RE, kSeen).tail<3>().norm(), 1e-4);
}

// Other tags at the very same places: the borders fit and half of the cells.
TEST(PhotometricFit, TagsOfOtherIdsAreNotOk) {
  const CameraCalibration camera = ScopeCamera();
  PhotometricFit fit({camera}, ScopeCollar());
  std::mt19937 random(3);
  for (int i = 0; i < 12; ++i) {
    const Image image = Frame(camera, ScopeCollar(0, 6 + 14 * i), kSeen);
    for (const double shift_px : {0.0, 1.5}) {
      const PhotometricResult r =
          fit.Fit({&image}, Off(shift_px, shift_px, random), {KnownGamma()});
      EXPECT_FALSE(r.IsUsable()) << i;
    }
  }
}

TEST(PhotometricFit, TwoCamerasKnowMoreThanEach) {
  const std::vector<CameraCalibration> cameras = {ScopeCamera(), SecondScopeCamera()};
  std::vector<Image> images;
  for (const CameraCalibration& camera : cameras) {
    images.push_back(Film(LightThroughLens(camera, ScopeCollar(), kSeen, kBlur_px), 2.2, 7));
  }
  PhotometricFit fit(cameras, ScopeCollar());
  const std::vector<OpticsPrior> priors(2, KnownGamma());
  const PhotometricResult both = fit.Fit({&images[0], &images[1]}, kSeen, priors);
  ASSERT_TRUE(both.IsUsable());
  EXPECT_LT(Nees(both, kSeen), 22.5);
  for (const int i : {0, 1}) {
    std::vector<const Image*> one(2, nullptr);
    one[i] = &images[i];
    const PhotometricResult single = fit.Fit(one, kSeen, priors);
    ASSERT_TRUE(single.IsUsable());
    EXPECT_LT(Nees(single, kSeen), 22.5);
    const double gain = single.covariance.bottomRightCorner<3, 3>().trace() /
                        both.covariance.bottomRightCorner<3, 3>().trace();
    EXPECT_GT(gain, 3) << i;
    const Matrix6 less = single.covariance - both.covariance;
    EXPECT_GT(SymmetricEigenvalues(less)[0], 0) << i;
  }
}

TEST(PhotometricFit, FindsWhereThePrintLies) {
  const CameraCalibration camera = ScopeCamera();
  const Pose T_RE = ScopePose(-0.4, 0.1);
  const Image image = Film(LightThroughLens(camera, ScopeCollar(5e-5), T_RE, kBlur_px), 2.2, 8);
  PhotometricFit fit({camera}, ScopeCollar());
  OpticsPrior prior = KnownGamma();
  prior.print_offset_sd_m = 1e-4;
  const PhotometricResult r = fit.Fit({&image}, T_RE, {prior});
  ASSERT_TRUE(r.IsUsable());
  const OpticsPrior& learned = r.views[0].learned;
  EXPECT_NEAR(learned.mean.print_offset_m, 5e-5, 3 * learned.print_offset_sd_m);
  EXPECT_LT(learned.print_offset_sd_m, 2e-5);
  EXPECT_LT(Nees(r, T_RE), 22.5);
}

// The start is right and the blur is not: what is left is still noise alone.
TEST(PhotometricFit, GoesOnUntilTheBlurIsRight) {
  const CameraCalibration camera = ScopeCamera();
  const Pose T_RE = ScopePose(0.4, 0.5);
  const Image image = Film(LightThroughLens(camera, ScopeCollar(), T_RE, 1.2), 2.2, 9);
  PhotometricFit fit({camera}, ScopeCollar());
  const PhotometricResult r = fit.Fit({&image}, T_RE, {KnownGamma()});
  ASSERT_TRUE(r.IsUsable());
  EXPECT_NEAR(r.views[0].learned.mean.blur_px2[0], 1.44, 0.06);
  EXPECT_NEAR(r.views[0].learned.mean.blur_px2[2], 1.44, 0.06);
  EXPECT_LT(r.views[0].noise_grey, 1.6);
}

}  // namespace
}  // namespace flextip
