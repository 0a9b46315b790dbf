// The uncertainty that is claimed beside the spread of calibrations from corners noised anew.
#include "calibration/uncertainty/projection_uncertainty.h"

#include <gtest/gtest.h>

#include "calibration/camera/bundle.h"
#include "calibration/camera/projection_derivative.h"
#include "calibration/stereo/bundle.h"
#include "calibration/uncertainty/next_view.h"
#include "core/derivative_check.h"
#include "core/linear_algebra.h"
#include "tests/calibration/stereo_scene.h"

namespace flextip {
namespace {

constexpr double kNoise_px = 0.1;

TEST(ProjectionDerivative, MatchesTheCameraModelAndDifferences) {
  const Eigen::Vector3d x_C(0.02, -0.013, 0.09);
  for (const auto& [distortion, terms] :
       {std::pair(Distortion::kRadialTangential, 4), std::pair(Distortion::kOpenCv, 5),
        std::pair(Distortion::kOpenCv, 8), std::pair(Distortion::kOpenCv, 12),
        std::pair(Distortion::kEquidistant, 4)}) {
    CameraCalibration camera = MakeStereoScene(0, 1).cameras[0];
    camera.distortion = distortion;
    camera.distortion_coefficients.clear();
    for (int i = 0; i < terms; ++i) camera.distortion_coefficients.push_back(0.03 / (1 + i));
    const ProjectionDerivative d = DifferentiateProjection(camera, x_C);
    EXPECT_LT((d.px - CameraModel(camera).Project(x_C).value()).norm(), 1e-9);
    const auto by_point = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      return CameraModel(camera).Project(x).value();
    };
    EXPECT_LT((d.by_point - NumericJacobian(by_point, x_C, 1e-4)).norm(), 1e-4);
    const auto by_lens = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
      return CameraModel(WithIntrinsics(camera, v)).Project(x_C).value();
    };
    EXPECT_LT((d.by_intrinsics - NumericJacobian(by_lens, IntrinsicsVector(camera), 1e-4)).norm(),
              1e-5);
  }
}

// Where a point that stands still relative to the boards is seen by a calibration: the mean over
// the boards of where it is in that camera, projected.
Eigen::Vector2d SeenBy(const CameraSolution& found, const CameraSolution& truth,
                       const Eigen::Vector3d& x_C) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t v = 0; v < truth.views.size(); ++v) {
    mean += found.views[v].T_CB * (truth.views[v].T_CB.Inverse() * x_C);
  }
  return CameraModel(found.camera).Project(mean / static_cast<double>(truth.views.size())).value();
}

CameraSolution Recalibrated(const CameraSolution& exact, std::mt19937& random) {
  CameraSolution s = exact;
  for (SolvedView& view : s.views) AddNoise(kNoise_px, random, view);
  EXPECT_TRUE(AdjustBundle(s, {.estimate_warp = true}));
  return s;
}

TEST(ProjectionUncertainty, IsTheSpreadOfCalibrationsFromOtherNoise) {
  const CameraSolution truth = MakeStereoScene(8, 3).ExactCamera();
  std::mt19937 random(5);
  CameraSolution at_truth = truth;
  ASSERT_TRUE(AdjustBundle(at_truth, {.estimate_warp = true}));
  at_truth.noise_px = kNoise_px;
  const auto claimed = ProjectionUncertainty::Of(at_truth);
  ASSERT_TRUE(claimed);
  const CameraModel model(truth.camera);
  struct Place {
    Eigen::Vector2d px;
    double depth_m;
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  };
  std::vector<Place> places = {
      {{400, 300}, 0.10}, {{30, 40}, 0.10}, {{780, 300}, 0.2}, {{30, 40}, 1e4}};
  constexpr int kRuns = 150;
  double mean_nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    const CameraSolution found = Recalibrated(truth, random);
    const auto own = ProjectionUncertainty::Of(found);
    ASSERT_TRUE(own);
    for (Place& place : places) {
      const Eigen::Vector3d ray = model.Unproject(place.px).value();
      const Eigen::Vector2d error = SeenBy(found, truth, ray / ray.z() * place.depth_m) - place.px;
      place.spread += error * error.transpose() / kRuns;
      mean_nees += MahalanobisSquared(error, *own->CovariancePx(place.px, place.depth_m)) /
                   (kRuns * static_cast<double>(places.size()));
    }
  }
  // Of a sample of 150 the standard deviation is known to 6 %.
  for (const Place& place : places) {
    const Eigen::Matrix2d covariance = claimed->CovariancePx(place.px, place.depth_m).value();
    EXPECT_NEAR(WorstSd(place.spread) / WorstSd(covariance), 1.0, 0.2) << place.px.transpose();
    EXPECT_NEAR(std::sqrt(place.spread.trace() / covariance.trace()), 1.0, 0.18);
  }
  EXPECT_NEAR(mean_nees, 2.0, 0.4);
  // Far away is as good as infinitely far away.
  EXPECT_NEAR(WorstSd(claimed->CovariancePx({30, 40}, HUGE_VAL).value()),
              WorstSd(claimed->CovariancePx({30, 40}, 1e4).value()), 1e-4);
}

// The same of the right one of two cameras, whose boards' poses are known by way of the left one.
TEST(ProjectionUncertainty, OfTheOtherEyeIsTheSpreadToo) {
  const StereoScene scene = MakeStereoScene(7, 3);
  const StereoSolution truth = scene.Exact();
  const std::vector<std::pair<Eigen::Vector2d, double>> places = {{{400, 300}, 0.10},
                                                                  {{60, 60}, 0.3}};
  const CameraModel model(scene.cameras[1]);
  std::mt19937 random(8);
  constexpr int kRuns = 60;
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    StereoSolution s = truth;
    for (StereoView& view : s.views) {
      for (SolvedView& eye : view.eyes) AddNoise(kNoise_px, random, eye);
    }
    ASSERT_TRUE(AdjustStereo(s));
    const auto uncertainty = ProjectionUncertainty::Of(s, 1);
    ASSERT_TRUE(uncertainty);
    for (const auto& [px, depth_m] : places) {
      const Eigen::Vector3d ray = model.Unproject(px).value(), x_C1 = ray / ray.z() * depth_m;
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (std::size_t v = 0; v < s.views.size(); ++v) {
        mean += s.T_CB(s.views[v], 1) * (truth.T_CB(truth.views[v], 1).Inverse() * x_C1);
      }
      const Eigen::Vector2d error =
          CameraModel(s.cameras[1]).Project(mean / static_cast<double>(s.views.size())).value() -
          px;
      nees += MahalanobisSquared(error, *uncertainty->CovariancePx(px, depth_m));
    }
  }
  // The two places are not independent: at worst a standard deviation of 2 / sqrt(60).
  EXPECT_NEAR(nees / (kRuns * 2), 2.0, 0.6);
}

TEST(ProjectionUncertainty, MapIsLeastWhereTheBoardsWere) {
  CameraSolution s = MakeStereoScene(8, 3).ExactCamera();
  ASSERT_TRUE(AdjustBundle(s));
  s.noise_px = kNoise_px;
  const auto u = ProjectionUncertainty::Of(s);
  ASSERT_TRUE(u);
  const double depth_m = MedianBoardDepth(s);
  EXPECT_NEAR(depth_m, 0.1, 0.02);
  const UncertaintyMap near = MapUncertainty(*u, depth_m), far = MapUncertainty(*u, HUGE_VAL);
  EXPECT_LT(near.CentrePx(), kNoise_px);
  EXPECT_GT(near.LargestPx(), 3 * near.CentrePx());
  EXPECT_GT(far.CentrePx(), near.CentrePx());
  EXPECT_EQ(far.sd_mm.size(), 0);
  // In the middle a pixel is depth / f.
  EXPECT_NEAR(near.sd_mm(9, 12), 1e3 * near.CentrePx() * depth_m / 900, 0.02 * near.sd_mm(9, 12));
}

TEST(ProjectionUncertainty, IsAbsentWhereTheViewsDoNotTell) {
  CameraSolution s = MakeStereoScene(1, 3).ExactCamera();
  s.noise_px = kNoise_px;
  s.normal_matrix = Eigen::MatrixXd::Zero(s.Size(), s.Size());
  EXPECT_FALSE(ProjectionUncertainty::Of(s));
}

CameraSolution AddView(const StereoScene& scene, CameraSolution s, const Pose& T_CB) {
  s.views.push_back(scene.See(s.views.size(), 0, T_CB));
  EXPECT_TRUE(AdjustBundle(s, {.estimate_warp = true}));
  s.noise_px = kNoise_px;
  return s;
}

double MeanPx(const CameraSolution& s) {
  return MapUncertainty(ProjectionUncertainty::Of(s).value(), 0.1).MeanPx();
}

TEST(NextView, LowersTheUncertaintyAsPredictedAndMoreThanOthers) {
  const StereoScene scene = MakeStereoScene(6, 7);
  CameraSolution s = scene.ExactCamera();
  ASSERT_TRUE(AdjustBundle(s, {.estimate_warp = true}));
  s.noise_px = kNoise_px;
  const auto before = ProjectionUncertainty::Of(s);
  const auto candidates = CandidateViews(s, scene.Points());
  ASSERT_GT(candidates.size(), 20u);
  const auto ranked = RankNextViews(*before, candidates, scene.Points(), {.depth_m = 0.1});
  ASSERT_EQ(ranked.size(), candidates.size());
  const NextView& best = ranked.front();
  EXPECT_NEAR(best.before_px, MeanPx(s), 1e-9);
  EXPECT_LT(best.after_px, 0.8 * best.before_px);
  // The view truly added: corners seen, bundle adjusted, its own normal matrix.
  EXPECT_NEAR(MeanPx(AddView(scene, s, best.T_CB)), best.after_px, 1e-3 * best.after_px);
  std::mt19937 random(1);
  double mean_of_random = 0;
  for (int i = 0; i < 10; ++i) {
    mean_of_random += MeanPx(AddView(scene, s, RandomBoardPose(scene, random))) / 10;
  }
  EXPECT_LT(best.after_px, 0.9 * mean_of_random);
}

TEST(NextView, SaysHowToHoldTheBoard) {
  const CameraCalibration camera = MakeStereoScene(0, 1).cameras[0];
  EXPECT_EQ(HoldTheBoard(camera, {0, 0, 0}, {Eigen::Matrix3d::Identity(), {0, 0, 0.3}}),
            "hold the board in the middle of the picture, 300 mm away, facing the camera");
  const Pose right_nearer{ExpRotation({0, 0.7, 0}), {-0.1, -0.07, 0.3}};
  EXPECT_LT((right_nearer * Eigen::Vector3d(0.01, 0, 0)).z(), 0.3);
  EXPECT_EQ(HoldTheBoard(camera, {0, 0, 0}, right_nearer),
            "hold the board in the upper left of the picture, 300 mm away, tilted by 40 deg, its "
            "right side nearer");
  const Pose lower_nearer{ExpRotation({-0.5, 0, 0}), {0, 0, 0.3}};
  EXPECT_LT((lower_nearer * Eigen::Vector3d(0, 0.01, 0)).z(), 0.3);
  EXPECT_NE(HoldTheBoard(camera, {0, 0, 0}, lower_nearer).find("lower side"), std::string::npos);
}

}  // namespace
}  // namespace flextip
