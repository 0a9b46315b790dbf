// Two cameras: known ones behind noise, and real ones.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "calibration/stereo/bundle.h"
#include "calibration/stereo/heldout.h"
#include "calibration/stereo/rectification.h"
#include "calibration/stereo/stereo_calibration.h"
#include "core/derivative_check.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "tests/calibration/stereo_scene.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

constexpr double kNoise_px = 0.08;

StereoSolution Noised(const StereoScene& scene, std::mt19937& random) {
  StereoSolution s = scene.Exact();
  for (StereoView& view : s.views) {
    for (SolvedView& eye : view.eyes) AddNoise(kNoise_px, random, eye);
  }
  return s;
}

// What AdjustStereo finds from the truth, less the truth, in the order of the normal matrix.
Eigen::VectorXd ErrorOf(const StereoSolution& found, const StereoScene& truth) {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(found.PairStart() + 6);
  int at = 0;
  for (int eye = 0; eye < 2; ++eye) {
    const CameraCalibration &f = found.cameras[eye], &t = truth.cameras[eye];
    error.segment<4>(at) << f.fu_px - t.fu_px, f.fv_px - t.fv_px, f.cu_px - t.cu_px,
        f.cv_px - t.cv_px;
    at += 4;
    for (int i = 0; i < 4; ++i) {
      error[at++] = f.distortion_coefficients[i] - t.distortion_coefficients[i];
    }
  }
  error.segment<6>(at) = PoseDifference(truth.T_C0C1, found.T_C0C1);
  return error;
}

TEST(StereoBundle, CovarianceIsTheSpreadOfWhatIsFound) {
  const StereoScene scene = MakeStereoScene(7, 2);
  std::mt19937 random(4);
  constexpr int kRuns = 200;
  double nees = 0, nees_pair = 0, inside = 0;
  for (int run = 0; run < kRuns; ++run) {
    StereoSolution s = Noised(scene, random);
    ASSERT_TRUE(AdjustStereo(s));
    const Eigen::VectorXd error = ErrorOf(s, scene);
    const Eigen::MatrixXd covariance = s.Covariance();
    ASSERT_GT(covariance.rows(), 0);
    const int n = static_cast<int>(error.size());
    nees += error.dot(Ldlt(covariance.topLeftCorner(n, n)).Solve(error)) / n / kRuns;
    const Eigen::Matrix<double, 6, 6> pair = covariance.block<6, 6>(n - 6, n - 6);
    nees_pair += MahalanobisSquared(error.tail<6>(), pair) / 6 / kRuns;
    const Baseline baseline = BaselineOf(s.T_C0C1, pair.bottomRightCorner<3, 3>());
    inside += std::abs(baseline.length_m - scene.T_C0C1.p.norm()) < baseline.sd_m ? 1.0 / kRuns : 0;
  }
  // Four standard deviations of the mean over the runs: of chi squares per degree of freedom
  // (22 and 6), and of a share of 0.683.
  EXPECT_NEAR(nees, 1.0, 4 * std::sqrt(2.0 / (22 * kRuns)));
  EXPECT_NEAR(nees_pair, 1.0, 4 * std::sqrt(2.0 / (6 * kRuns)));
  EXPECT_NEAR(inside, 0.683, 4 * std::sqrt(0.683 * 0.317 / kRuns));
}

// All residuals of the bundle with a shape, the corners' hold on their places among them.
Eigen::VectorXd Residuals(const StereoSolution& s, const Eigen::VectorXd& step) {
  StereoSolution moved = s;
  for (int eye = 0; eye < 2; ++eye) {
    CameraCalibration& c = moved.cameras[eye];
    const Eigen::VectorXd by = step.segment(8 * eye, 8);
    c.fu_px += by[0], c.fv_px += by[1], c.cu_px += by[2], c.cv_px += by[3];
    for (int k = 0; k < 4; ++k) c.distortion_coefficients[k] += by[4 + k];
  }
  const auto turned = [](const Pose& T, const Eigen::VectorXd& by) {
    return Pose{ExpRotation(by.head<3>()) * T.R, T.p + by.tail<3>()};
  };
  moved.T_C0C1 = turned(s.T_C0C1, step.segment(16, 6));
  std::vector<double> r;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    moved.views[v].T_C0B = turned(s.views[v].T_C0B, step.segment(s.ViewStart(v), 6));
    for (int eye = 0; eye < 2; ++eye) {
      const SolvedView& seen = s.views[v].eyes[eye];
      const CameraModel model(moved.cameras[eye]);
      for (std::size_t i = 0; i < seen.px.size(); ++i) {
        const Eigen::Vector3d place =
            seen.x_B[i] + s.shape.Of(seen.ids[i]) + step.segment<3>(s.Size() + 3 * seen.ids[i]);
        const auto px = model.Project(moved.T_CB(moved.views[v], eye) * place).value();
        r.insert(r.end(), {px.x(), px.y()});
      }
    }
  }
  const double weight = s.noise_px / s.shape.sd_m;
  for (Eigen::Index k = s.Size(); k < step.size(); ++k) r.push_back(weight * step[k]);
  return Eigen::Map<Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
}

// The inverse of the normal matrix that is left is a block of the whole one's.
TEST(StereoBundle, TheShapeIsEliminatedAsByDifferences) {
  const StereoScene scene = MakeStereoScene(3, 2);
  StereoSolution s = scene.Exact();
  s.noise_px = 0.1;
  s.shape.sd_m = 2e-5;
  ASSERT_TRUE(AdjustStereo(s, {.estimate_shape = true}));
  s.noise_px = 0.1;  // with which it was held
  const Eigen::Index n = s.Size(), all = n + 3 * 48;
  const Eigen::MatrixXd J =
      NumericJacobian([&](const Eigen::VectorXd& step) { return Residuals(s, step); },
                      Eigen::VectorXd::Zero(all), 1e-5);
  const Eigen::MatrixXd whole = J.transpose() * J;
  const Eigen::MatrixXd eliminated =
      whole.topLeftCorner(n, n) -
      whole.topRightCorner(n, all - n) *
          Llt(whole.bottomRightCorner(all - n, all - n)).Solve(whole.bottomLeftCorner(all - n, n));
  EXPECT_TRUE(s.normal_matrix.isApprox(eliminated, 1e-6));
}

TEST(StereoBundle, ViewsOfOneEyeAndAWarpedBoardAreUsed) {
  StereoScene scene = MakeStereoScene(10, 2);
  scene.warp.bulge_m = {1e-4, -5e-5};
  std::mt19937 random(4);
  StereoSolution s = Noised(scene, random);
  for (int i = 6; i < 10; ++i) s.views[i].eyes[i % 2] = SolvedView();
  s.warp.bulge_m.setZero();
  StereoSolution flat = s;
  ASSERT_TRUE(AdjustStereo(flat));
  ASSERT_TRUE(AdjustStereo(s, {.estimate_warp = true}));
  EXPECT_NEAR(s.RmsPx(), kNoise_px * std::sqrt(2.0), 0.01);
  EXPECT_GT(flat.RmsPx(), 1.1 * s.RmsPx());
  const Eigen::MatrixXd covariance = s.Covariance();
  ASSERT_EQ(covariance.rows(), 8 + 8 + 6 + 2 + 60);
  for (int i = 0; i < 2; ++i) {
    const int at = s.PairStart() + 6 + i;
    EXPECT_NEAR(s.warp.bulge_m[i], scene.warp.bulge_m[i], 4 * std::sqrt(covariance(at, at)));
  }
  const Eigen::VectorXd error = ErrorOf(s, scene);
  for (int i = 0; i < error.size(); ++i) {
    EXPECT_LT(std::abs(error[i]), 4 * std::sqrt(covariance(i, i))) << i;
  }
  // What only one eye saw makes both surer.
  StereoSolution pairs_only = s;
  pairs_only.views.resize(6);
  ASSERT_TRUE(AdjustStereo(pairs_only, {.estimate_warp = true}));
  EXPECT_LT(covariance(0, 0) / std::pow(s.noise_px, 2),
            pairs_only.Covariance()(0, 0) / std::pow(pairs_only.noise_px, 2));
}

std::vector<StereoPair> AsPairs(const StereoSolution& s) {
  std::vector<StereoPair> pairs;
  for (const StereoView& view : s.views) {
    StereoPair pair;
    for (int eye = 0; eye < 2; ++eye) {
      pair.eyes[eye].name = fmt::format("{} {}", eye == 0 ? "left" : "right", pairs.size());
      BoardSighting& seen = pair.eyes[eye].sighting;
      seen.ids = view.eyes[eye].ids;
      seen.x_B = view.eyes[eye].x_B;
      seen.px = view.eyes[eye].px;
      if (!seen.Found()) seen.reason = "no board";
    }
    pairs.push_back(pair);
  }
  return pairs;
}

StereoOptions Radial() {
  StereoOptions options;
  options.camera.lens = LensModel{Distortion::kRadialTangential, 4};
  options.camera.warp = false;
  return options;
}

// A board that is not as described is told from one that is, by pairs left out; the baseline is
// then what it claims to be.
TEST(StereoCalibration, SeesABoardThatIsNotAsDescribed) {
  const StereoScene scene = MakeStereoScene(12, 6);
  const Eigen::Vector2i size(800, 600);
  std::mt19937 random(3);
  std::normal_distribution<double> off(0, 2e-5);
  StereoSolution s = Noised(scene, random);
  const StereoResult as_described =
      CalibrateStereo(AsPairs(s), {size, size}, scene.board, Radial());
  ASSERT_TRUE(as_described.IsUsable()) << as_described.message;
  EXPECT_EQ(as_described.solution.shape.sd_m, 0.0) << as_described.shape_reason;
  std::map<int, Eigen::Vector3d> offsets;
  for (int id = 0; id < 48; ++id) offsets[id] = {off(random), off(random), off(random)};
  for (StereoView& view : s.views) {
    for (SolvedView& eye : view.eyes) {
      for (std::size_t i = 0; i < eye.x_B.size(); ++i) eye.x_B[i] -= offsets[eye.ids[i]];
    }
  }
  const StereoResult r = CalibrateStereo(AsPairs(s), {size, size}, scene.board, Radial());
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_NEAR(r.solution.shape.sd_m, 2e-5, 5e-6) << r.shape_reason;
  EXPECT_NEAR(r.solution.noise_px, kNoise_px, 0.05 * kNoise_px);
  EXPECT_NEAR(r.baseline.length_m, scene.T_C0C1.p.norm(), 3 * r.baseline.sd_m);
}

TEST(StereoCalibration, FindsThePairThatIsNotOfOneMoment) {
  const StereoScene scene = MakeStereoScene(12, 6);
  std::mt19937 random(9);
  StereoSolution s = Noised(scene, random);
  // The right picture of pair 4 is of another moment; pair 7 has none.
  s.views[4].eyes[1] = scene.See(4, 1, RandomBoardPose(scene, random));
  AddNoise(kNoise_px, random, s.views[4].eyes[1]);
  s.views[7].eyes[1] = SolvedView();
  const Eigen::Vector2i size(800, 600);
  const StereoResult r = CalibrateStereo(AsPairs(s), {size, size}, scene.board, Radial());
  ASSERT_TRUE(r.IsUsable()) << r.message;
  ASSERT_EQ(r.pairs.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(r.pairs[i].apart.empty(), i != 4) << i;
  EXPECT_EQ(r.pairs[7].reasons[1], "no board");
  EXPECT_EQ(r.pairs_used, 10);
  EXPECT_EQ(r.single_views_used, 3);
  EXPECT_NEAR(r.baseline.length_m, scene.T_C0C1.p.norm(), 4 * r.baseline.sd_m);
  EXPECT_LT(r.baseline.sd_m, 1e-4);
  EXPECT_NEAR(r.solution.RmsPx(), kNoise_px * std::sqrt(2.0), 0.01);
  ASSERT_TRUE(r.heldout);
  EXPECT_NEAR(r.heldout->rms_px, kNoise_px * std::sqrt(2.0), 0.015);
  // A difference of two rows.
  EXPECT_NEAR(r.epipolar_rms_px, kNoise_px * std::sqrt(2.0), 0.03);
  EXPECT_NEAR(r.heldout->epipolar_rms_px, kNoise_px * std::sqrt(2.0), 0.04);
}

TEST(StereoCalibration, SaysWhyNot) {
  const StereoScene scene = MakeStereoScene(8, 6);
  std::mt19937 random(9);
  StereoSolution s = Noised(scene, random);
  const Eigen::Vector2i size(800, 600);
  for (int i = 0; i < 8; ++i) s.views[i].eyes[i % 2] = SolvedView();
  const StereoResult apart = CalibrateStereo(AsPairs(s), {size, size}, scene.board, Radial());
  EXPECT_EQ(apart.status, StereoStatus::kTooFewPairs) << apart.message;
  for (StereoView& view : s.views) view.eyes[1] = SolvedView();
  const StereoResult blind = CalibrateStereo(AsPairs(s), {size, size}, scene.board, Radial());
  EXPECT_EQ(blind.status, StereoStatus::kEyeFailed);
  EXPECT_EQ(blind.message.find("right camera"), 0u) << blind.message;
}

TEST(StereoRectification, PutsAPointInOneRowAtItsDepth) {
  const StereoScene scene = MakeStereoScene(0, 1);
  const Rectification r = Rectify(scene.cameras, scene.T_C0C1);
  const CameraModel left(scene.cameras[0]), right(scene.cameras[1]);
  for (const Eigen::Vector3d& x_C0 :
       {Eigen::Vector3d(0, 0, 0.1), Eigen::Vector3d(0.03, 0.01, 0.2)}) {
    const auto a = RectifiedPixel(r, 0, scene.cameras[0], left.Project(x_C0).value());
    const auto b = RectifiedPixel(r, 1, scene.cameras[1],
                                  right.Project(scene.T_C0C1.Inverse() * x_C0).value());
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->y(), b->y(), 1e-6);
    const Eigen::Vector4d x = r.Q() * Eigen::Vector4d(a->x(), a->y(), a->x() - b->x(), 1);
    EXPECT_LT((x.hnormalized() - r.R[0] * x_C0).norm(), 1e-9);
  }
  // All of the rectified picture is seen.
  for (int eye = 0; eye < 2; ++eye) {
    const Eigen::Matrix3d K = r.P[eye].leftCols<3>();
    for (const Eigen::Vector3d& px : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(799, 0, 1),
                                      Eigen::Vector3d(0, 599, 1), Eigen::Vector3d(799, 599, 1)}) {
      const auto at =
          CameraModel(scene.cameras[eye]).Project(r.R[eye].transpose() * K.inverse() * px);
      ASSERT_TRUE(at);
      EXPECT_GE(at->minCoeff(), -1.0);
      EXPECT_LE(at->x(), 800.0);
      EXPECT_LE(at->y(), 600.0);
    }
  }
  EXPECT_THROW(Rectify(scene.cameras, {Eigen::Matrix3d::Identity(), {0, 0, 0.01}}), InputError);
}

}  // namespace
}  // namespace flextip
