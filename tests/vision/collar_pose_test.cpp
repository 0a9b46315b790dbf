// The collar's pose from corners that are known, exactly and with known noise.
#include "vision/tags/collar_pose.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"

#include <gtest/gtest.h>

#include <random>

#include "core/derivative_check.h"
#include "core/rotation.h"
#include "tests/vision/synthetic_tag.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

const TagCollar kCollar = PrismCollar(6, 0.005, 0.005, -0.03);

// A tip some 10 cm before the camera, the shaft across the picture, turned at random.
Pose RandomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Pose T_CE;
  const double around = M_PI * u(random);
  const Eigen::Vector3d turn = 0.5 * DrawVector<3>(u, random), at = DrawVector<3>(u, random);
  T_CE.R = ExpRotation(turn) * ExpRotation({around, 0, 0});
  T_CE.p = Eigen::Vector3d(0.03 + 0.01 * at.x(), 0.01 * at.y(), 0.10 + 0.02 * at.z());
  return T_CE;
}

TEST(CollarPose, ExactCornersGiveTheExactPose) {
  const CameraCalibration camera = TestCamera(true);
  const CameraModel model(camera);
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    const Pose T_CE = RandomPose(random);
    auto tags = NoisyTags(camera, kCollar, T_CE, 0, random);
    ASSERT_FALSE(tags.empty());
    if (i % 3 == 0) tags.resize(1);
    const CollarPose pose = EstimateCollarPose(model, kCollar, tags);
    ASSERT_TRUE(pose.IsUsable()) << i;
    EXPECT_EQ(pose.tags_used, static_cast<int>(tags.size()));
    EXPECT_LT(PoseDifference(T_CE, pose.T_CE).norm(), 1e-7) << i;
    EXPECT_LT(pose.rms_px, 1e-6);
  }
}

TEST(CollarPose, NormalEquationsAgreeWithCentralDifferences) {
  const CameraCalibration camera = TestCamera(true);
  const CameraModel model(camera);
  std::mt19937 random(4);
  const Pose T_CE = RandomPose(random);
  std::vector<Correspondence> points;
  for (const PlacedTag& tag : FacingTags(kCollar, T_CE)) {
    const auto corners_E = CornersInE(kCollar.tags[tag.id]);
    const auto seen = TrueCorners(camera, tag);
    for (int i = 0; i < 4; ++i) {
      points.push_back({corners_E[i], seen[i] + Eigen::Vector2d(0.3 * i, -0.2)});
    }
  }
  const auto residuals = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    const Pose moved = MovePose(T_CE, step);
    Eigen::VectorXd r(2 * static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      r.segment<2>(2 * static_cast<Eigen::Index>(i)) =
          *model.Project(moved * points[i].x_E) - points[i].px;
    }
    return r;
  };
  const Eigen::MatrixXd J = NumericJacobian(residuals, Eigen::VectorXd::Zero(6), 1e-5);
  const Eigen::VectorXd r = residuals(Eigen::VectorXd::Zero(6));
  const auto error = Reproject(model, points, T_CE);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->squared_px2, r.squaredNorm(), 1e-9);
  EXPECT_LT((error->JtJ - J.transpose() * J).norm(), 1e-6 * error->JtJ.norm());
  EXPECT_LT((error->Jtr - J.transpose() * r).norm(), 1e-6 * error->Jtr.norm());
}

// The mean of a chi-square over n trials with `dof` degrees has standard deviation sqrt(2 dof / n).
TEST(CollarPose, CovarianceMatchesTheScatterForKnownNoise) {
  const CameraCalibration camera = TestCamera(true);
  const CameraModel model(camera);
  for (const double noise_px : {0.1, 0.3}) {
    std::mt19937 random(5);
    CollarPoseOptions options;  // the noise is known from before
    options.prior_variance_px2 = noise_px * noise_px;
    options.prior_dof = 1000;
    double sum6 = 0, sum3 = 0;
    int n = 0;
    for (int i = 0; i < 1500; ++i) {
      const Pose T_CE = RandomPose(random);
      const auto tags = NoisyTags(camera, kCollar, T_CE, noise_px, random);
      if (tags.size() < 2) continue;  // one tag alone may flip: another test
      const CollarPose pose = EstimateCollarPose(model, kCollar, tags, options);
      ASSERT_TRUE(pose.IsUsable());
      const Eigen::Matrix<double, 6, 1> e = PoseDifference(pose.T_CE, T_CE);
      sum6 += MahalanobisSquared(e, pose.covariance);
      const Eigen::Matrix3d of_tip = pose.covariance.bottomRightCorner<3, 3>();
      sum3 += MahalanobisSquared(e.tail<3>(), of_tip);
      ++n;
    }
    ASSERT_GT(n, 1000);
    EXPECT_NEAR(sum6 / n, 6.0, 4 * std::sqrt(12.0 / n)) << noise_px;
    EXPECT_NEAR(sum3 / n, 3.0, 4 * std::sqrt(6.0 / n)) << noise_px;
  }
}

TEST(CollarPose, OneTagFacingTheCameraIsAmbiguousAndSaysSo) {
  const CameraCalibration camera = TestCamera(false);
  const CameraModel model(camera);
  std::mt19937 random(6);
  Pose T_CE;  // tag 0 sees the camera almost along its normal, from afar
  T_CE.R = ExpRotation({0.1, 0.12, 0}) * kCollar.tags[0].T_EG.R.transpose();
  T_CE.p = Eigen::Vector3d(0.03, 0, 0.3);
  int wrong = 0, ambiguous = 0;
  double nees = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    auto tags = NoisyTags(camera, kCollar, T_CE, 0.1, random, 0.4);
    ASSERT_EQ(tags.size(), 1u);
    const CollarPose pose = EstimateCollarPose(model, kCollar, tags);
    ASSERT_TRUE(pose.IsUsable());
    ambiguous += pose.ambiguous;
    EXPECT_EQ(pose.ambiguous && !pose.alternative, false);
    const Eigen::Matrix<double, 6, 1> e = PoseDifference(pose.T_CE, T_CE);
    wrong += e.head<3>().norm() > 0.15;
    const Eigen::Matrix3d of_tip = pose.covariance.bottomRightCorner<3, 3>();
    nees += MahalanobisSquared(e.tail<3>(), of_tip) / kTrials;
    // An earlier pose decides.
    const CollarPose near = EstimateCollarPose(model, kCollar, tags, {}, T_CE);
    EXPECT_LE(PoseDifference(near.T_CE, T_CE).head<3>().norm(), e.head<3>().norm() + 1e-6);
  }
  EXPECT_GT(ambiguous, kTrials * 8 / 10);  // now and then noise leaves one minimum only
  EXPECT_GT(wrong, 0);  // else the case is not ambiguous and the test shows nothing
  EXPECT_LT(nees, 6.0);
}

TEST(CollarPose, ATagInTheWrongPlaceIsLeftOut) {
  const CameraCalibration camera = TestCamera(true);
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) {
    const Pose T_CE = RandomPose(random);
    auto tags = NoisyTags(camera, kCollar, T_CE, 0.02, random, 1.4);
    if (tags.size() < 3) continue;
    for (Eigen::Vector2d& corner : tags[1].corners_px) corner += Eigen::Vector2d(25, -10);
    const CollarPose pose = EstimateCollarPose(CameraModel(camera), kCollar, tags);
    ASSERT_TRUE(pose.IsUsable());
    EXPECT_EQ(pose.tags_used, static_cast<int>(tags.size()) - 1);
    EXPECT_LT((pose.T_CE.p - T_CE.p).norm(), 1.5e-3);
  }
}

TEST(CollarPose, StatusWithoutUsableTags) {
  const CameraCalibration camera = TestCamera(true);
  const CameraModel model(camera);
  std::mt19937 random(8);
  EXPECT_EQ(EstimateCollarPose(model, kCollar, {}).status, CollarPoseStatus::kNoTags);
  auto tags = NoisyTags(camera, kCollar, RandomPose(random), 0, random);
  for (TagDetection& tag : tags) tag.id += 100;
  EXPECT_EQ(EstimateCollarPose(model, kCollar, tags).status, CollarPoseStatus::kNoTags);
  TagDetection flat;  // corners in a line
  for (int i = 0; i < 4; ++i) flat.corners_px[i] = Eigen::Vector2d(300 + 20 * i, 300);
  const CollarPose pose = EstimateCollarPose(model, kCollar, {flat});
  EXPECT_FALSE(pose.IsUsable());
  EXPECT_TRUE(pose.covariance.allFinite());
}

}  // namespace
}  // namespace flextip
