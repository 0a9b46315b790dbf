// Bundle adjustment against known truth: what it finds, and how sure it says it is.
#include "calibration/camera/bundle.h"

#include <gtest/gtest.h>

#include "calibration/camera/start.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "tests/calibration/camera_synthetic.h"

namespace flextip {
namespace {

// Two pixels to each corner's side, as a pose step moves it, by finite differences of the whole.
TEST(CameraBundle, NormalMatrixIsThatOfFiniteDifferences) {
  const Synthetic truth{.bulge_m = {3e-4, -5e-4}, .noise_px = 0.0, .views = 3};
  const auto views = Seen(truth, 1);
  const CameraSolution flat = AtTruth(truth, views, {});
  auto start = StartSolution(flat.views, 640, 480, false);
  ASSERT_TRUE(start);
  CameraSolution s = AtTruth(truth, views, start->views);
  ASSERT_TRUE(AdjustBundle(s, {.estimate_warp = true, .tolerance = 1e-14}));
  const auto residuals = [&](const Eigen::VectorXd& step) {
    CameraSolution moved = s;
    const Eigen::VectorXd c = Intrinsics(s.camera) + step.head(8);
    moved.camera.fu_px = c[0];
    moved.camera.fv_px = c[1];
    moved.camera.cu_px = c[2];
    moved.camera.cv_px = c[3];
    moved.camera.distortion_coefficients.assign(c.data() + 4, c.data() + 8);
    moved.warp.bulge_m += step.segment<2>(8);
    const CameraModel model(moved.camera);
    std::vector<double> r;
    for (std::size_t v = 0; v < s.views.size(); ++v) {
      const auto d = step.segment<6>(s.ViewStart(v));
      const Pose T_CB{ExpRotation(d.head<3>()) * s.views[v].T_CB.R,
                      s.views[v].T_CB.p + d.tail<3>()};
      for (const Eigen::Vector3d& x : s.views[v].x_B) {
        const auto px = model.Project(T_CB * moved.warp.Bent(x)).value();
        r.insert(r.end(), {px.x(), px.y()});
      }
    }
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(r.data(), static_cast<int>(r.size())));
  };
  const int n = s.Size();
  ASSERT_EQ(n, 8 + 2 + 18);
  Eigen::MatrixXd J(2 * 3 * 54, n);
  for (int i = 0; i < n; ++i) {
    const double h = i < 4 ? 1e-3 : 1e-6;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, i);
    J.col(i) = (residuals(step) - residuals(-step)) / (2 * h);
  }
  EXPECT_TRUE(s.normal_matrix.isApprox(J.transpose() * J, 1e-6));
}

// The covariance is what it says: errors weighed by it are chi-squared with as many degrees of
// freedom as there are numbers. Lens and warp together.
TEST(CameraBundle, CovarianceIsThatOfManyTrials) {
  constexpr int kTrials = 60, kNumbers = 8 + 2;
  Synthetic truth{.bulge_m = {3e-4, -5e-4}, .noise_px = 0.0, .views = 6};
  const auto exact = Seen(truth, 100);
  const auto start = StartSolution(AtTruth(truth, exact, {}).views, 640, 480, false);
  ASSERT_TRUE(start);
  CameraSolution known = AtTruth(truth, exact, start->views);
  ASSERT_TRUE(AdjustBundle(known, {.fix_intrinsics = true}));
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.15);
  double nees = 0.0, noise_px = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    CameraSolution s = known;
    for (SolvedView& view : s.views) {
      for (Eigen::Vector2d& px : view.px) px += DrawVector<2>(noise, random);
    }
    ASSERT_TRUE(AdjustBundle(s, {.estimate_warp = true}));
    Eigen::VectorXd error(kNumbers);
    error << Intrinsics(s.camera) - Intrinsics(truth.camera), s.warp.bulge_m - truth.bulge_m;
    const Eigen::MatrixXd covariance = s.Covariance().topLeftCorner(kNumbers, kNumbers);
    nees += MahalanobisSquared(error, covariance) / kTrials;
    noise_px += s.noise_px / kTrials;
  }
  // The mean of 60 such: 10, with a standard deviation of sqrt(2 * 10 / 60) = 0.58.
  EXPECT_NEAR(nees, kNumbers, 3 * 0.58);
  EXPECT_NEAR(noise_px, 0.15, 0.002);
}

TEST(CameraBundle, AMirroredPoseIsFoundOut) {
  const Synthetic truth{.noise_px = 0.05, .views = 5};
  const auto views = Seen(truth, 9);
  const auto start = StartSolution(AtTruth(truth, views, {}).views, 640, 480, false);
  ASSERT_TRUE(start);
  CameraSolution s = *start;
  // Far away and seen small, a board and its mirror image about the line of sight look alike.
  Pose& T_CB = s.views[2].T_CB;
  const Pose good = T_CB;
  const Eigen::Vector3d middle = T_CB * Eigen::Vector3d(0.1, 0.0625, 0),
                        sight = middle.normalized();
  const Eigen::Vector3d normal = T_CB.R.col(2);
  T_CB.R = RotationWithoutTwist(normal, 2 * normal.dot(sight) * sight - normal) * T_CB.R;
  T_CB.p = middle - T_CB.R * Eigen::Vector3d(0.1, 0.0625, 0);
  TryMirroredPoses(s, 1.0);
  EXPECT_LT(LogRotation(s.views[2].T_CB.R * good.R.transpose()).norm(), 1e-3);
}

TEST(CameraBundle, VanishingPointsGiveTheFocalLength) {
  Synthetic truth{.noise_px = 0.05, .views = 6};
  truth.camera.fv_px = truth.camera.fu_px;
  truth.camera.cu_px = 319.5;
  truth.camera.cv_px = 239.5;
  truth.camera.distortion_coefficients = {0, 0, 0, 0};
  const auto views = AtTruth(truth, Seen(truth, 4), {}).views;
  const auto focal = FocalOfVanishingPoints(views, {319.5, 239.5});
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 520, 5);
}

}  // namespace
}  // namespace flextip
