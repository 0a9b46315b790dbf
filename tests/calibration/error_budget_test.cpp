// The budget beside what the tip does when each input is truly disturbed.
#include "calibration/uncertainty/error_budget.h"

#include <gtest/gtest.h>

#include <random>

#include "calibration/camera/projection_derivative.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "kinematics/tip_bending.h"
#include "vision/tags/collar_pose.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

CameraCalibration Camera() {
  CameraCalibration c;
  c.width_px = 1280;
  c.height_px = 720;
  c.fu_px = c.fv_px = 950;
  c.cu_px = 646;
  c.cv_px = 355;
  c.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  c.T_RC = {ExpRotation({2.1, 0.3, -0.4}), {0.2, 0.05, 0.08}};
  return c;
}

// Two faces of a hexagonal collar 30 mm behind the tip.
TagCollar Collar() {
  TagCollar collar;
  for (int face = 0; face < 2; ++face) {
    CollarTag tag;
    tag.id = face;
    tag.size_m = 0.005;
    const double angle = M_PI / 3 * face - M_PI / 6;
    const Eigen::Vector3d out(0, std::sin(angle), -std::cos(angle));  // away from the shaft
    tag.T_EG.R.col(0) = Eigen::Vector3d::UnitX();
    tag.T_EG.R.col(2) = -out;
    tag.T_EG.R.col(1) = tag.T_EG.R.col(2).cross(tag.T_EG.R.col(0));
    tag.T_EG.p = Eigen::Vector3d(-0.03, 0, 0) + 0.005 * out;
    collar.tags.push_back(tag);
  }
  return collar;
}

const Pose kT_CE = {ExpRotation({0.1, 0.5, 0.3}), {0.012, -0.006, 0.09}};

std::vector<TagDetection> SeenBy(const CameraCalibration& camera, const TagCollar& collar) {
  const CameraModel model(camera);
  std::vector<TagDetection> tags;
  for (const CollarTag& tag : collar.tags) {
    TagDetection seen;
    seen.id = tag.id;
    const auto corners = CornersInE(tag);
    for (int i = 0; i < 4; ++i) seen.corners_px[i] = model.Project(kT_CE * corners[i]).value();
    tags.push_back(seen);
  }
  return tags;
}

// A covariance with correlations, of the given standard deviations.
Eigen::MatrixXd Correlated(const Eigen::VectorXd& sd) {
  const Eigen::Index n = sd.size();
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) correlation(i, i + 1) = correlation(i + 1, i) = 0.4;
  return sd.asDiagonal() * correlation * sd.asDiagonal();
}

const BudgetPart& Part(const TipBudget& budget, const std::string& name) {
  for (const BudgetPart& part : budget.parts) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "no part " << name;
  return budget.parts.front();
}

// The tip as vision says it, with its inputs as they are given.
Eigen::Vector3d Tip(const CameraCalibration& camera, const TagCollar& collar,
                    const std::vector<TagDetection>& tags, const Eigen::Vector3d& offset_E) {
  const CollarPose pose = EstimateCollarPose(CameraModel(camera), collar, tags);
  EXPECT_TRUE(pose.IsUsable());
  return camera.T_RC * (pose.T_CE * offset_E);
}

void ExpectSpread(const Eigen::Matrix3d& spread, const Eigen::Matrix3d& claimed,
                  const Eigen::Vector3d& depth_R) {
  const DepthAndAcross s = SplitByDepth(spread, depth_R), c = SplitByDepth(claimed, depth_R);
  // Of 400 draws a standard deviation is known to 3.5 %.
  EXPECT_NEAR(s.depth_m / c.depth_m, 1.0, 0.12);
  EXPECT_NEAR(s.across_m / c.across_m, 1.0, 0.12);
  EXPECT_LT((spread - claimed).norm(), 0.25 * claimed.norm());
}

class ErrorBudget : public testing::Test {
 protected:
  ErrorBudget() {
    Eigen::VectorXd lens_sd(8), pose_sd(6);
    lens_sd << 1.5, 1.5, 1, 1, 3e-3, 5e-3, 3e-4, 3e-4;
    pose_sd << 2e-3, 1e-3, 1e-3, 2e-4, 3e-4, 1e-4;
    chain.lens = Correlated(lens_sd);
    chain.hand_eye = Correlated(pose_sd);
    chain.tip_offset = Correlated(Eigen::Vector3d(2e-4, 1e-4, 1e-4));
    const auto found = BudgetOfTip(camera, collar, tags, chain);
    EXPECT_TRUE(found);
    budget = *found;
  }

  // The spread of the tip when `disturb` changes camera, offset and corners at random.
  template <class Disturb>
  Eigen::Matrix3d Spread(const Disturb& disturb) {
    constexpr int kDraws = 400;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    const Eigen::Vector3d truth = Tip(camera, collar, tags, {0, 0, 0});
    for (int i = 0; i < kDraws; ++i) {
      CameraCalibration c = camera;
      Eigen::Vector3d offset_E = Eigen::Vector3d::Zero();
      auto seen = tags;
      disturb(c, offset_E, seen);
      const Eigen::Vector3d error = Tip(c, collar, seen, offset_E) - truth;
      spread += error * error.transpose() / kDraws;
    }
    return spread;
  }

  Eigen::VectorXd Draw(const Eigen::MatrixXd& covariance) {
    Eigen::VectorXd z(covariance.rows());
    for (double& v : z) v = normal(random);
    return Llt(covariance).L() * z;
  }

  const CameraCalibration camera = Camera();
  const TagCollar collar = Collar();
  const std::vector<TagDetection> tags = SeenBy(camera, collar);
  ChainCovariance chain;
  TipBudget budget;
  std::mt19937 random{7};
  std::normal_distribution<double> normal;
};

TEST_F(ErrorBudget, LensIsTheSpreadOverOtherLenses) {
  const auto spread = Spread([&](CameraCalibration& c, Eigen::Vector3d&, auto&) {
    c = WithIntrinsics(c, IntrinsicsVector(c) + Draw(chain.lens));
  });
  ExpectSpread(spread, Part(budget, "lens").covariance_R, budget.depth_R);
}

TEST_F(ErrorBudget, AllTogetherAreTheSpreadOverAll) {
  std::normal_distribution<double> corner(0, 0.1);  // as EstimateCollarPose's prior has it
  const auto spread = Spread([&](CameraCalibration& c, Eigen::Vector3d& offset_E, auto& seen) {
    c = WithIntrinsics(c, IntrinsicsVector(c) + Draw(chain.lens));
    c.T_RC = MovePose(c.T_RC, Draw(chain.hand_eye));
    offset_E = Draw(chain.tip_offset);
    for (TagDetection& tag : seen) {
      for (Eigen::Vector2d& px : tag.corners_px) px += DrawVector<2>(corner, random);
    }
  });
  // The exact corners' own covariance says less than the noise that is put on them here.
  auto noisy = tags;
  for (TagDetection& tag : noisy) {
    for (Eigen::Vector2d& px : tag.corners_px) px += DrawVector<2>(corner, random);
  }
  const CollarPose pose = EstimateCollarPose(CameraModel(camera), collar, noisy);
  const double scale = std::pow(0.1 / pose.corner_noise_px, 2);
  Eigen::Matrix3d claimed = budget.TotalCovariance() - Part(budget, "pixels").covariance_R;
  claimed +=
      scale * camera.T_RC.R * pose.covariance.bottomRightCorner<3, 3>() * camera.T_RC.R.transpose();
  ExpectSpread(spread, claimed, budget.depth_R);
}

TEST_F(ErrorBudget, PartsThatAreNotKnownAreNotThere) {
  const auto only_pixels = BudgetOfTip(camera, collar, tags, {});
  ASSERT_TRUE(only_pixels);
  ASSERT_EQ(only_pixels->parts.size(), 1u);
  EXPECT_EQ(only_pixels->parts[0].name, "pixels");
  EXPECT_FALSE(BudgetOfTip(camera, collar, {}, chain));
  EXPECT_EQ(budget.parts.size(), 4u);
}

TEST_F(ErrorBudget, BendingIsWhatTheRodBends) {
  const TipBending bending{.f_R = {0.2, -0.1, 0.3}, .stiffness_Nm2 = 0.3, .stiffness_sd_Nm2 = 0.03};
  const auto bent = BudgetOfTip(camera, collar, tags, chain, bending);
  ASSERT_TRUE(bent);
  // By integration of the moment (L - s) f / (E I) twice.
  const Eigen::Vector3d axis = camera.T_RC.R * kT_CE.R.col(0);
  const Eigen::Vector3d f = bending.f_R - axis * axis.dot(bending.f_R);
  Eigen::Vector3d bend = Eigen::Vector3d::Zero(), slope = Eigen::Vector3d::Zero();
  constexpr int kSteps = 3000;
  const double length_m = 0.0275;  // the tags' near edge to the tip
  const double h = length_m / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector3d curvature = f * (length_m - (i + 0.5) * h) / 0.3;
    bend += h * (slope + 0.5 * h * curvature);
    slope += h * curvature;
  }
  EXPECT_LT((bent->bend_R - bend).norm(), 1e-5 * bend.norm());
  EXPECT_NEAR(std::sqrt(Part(*bent, "stiffness").covariance_R.trace()), 0.1 * bend.norm(),
              1e-4 * bend.norm());
  EXPECT_FALSE(Part(*bent, "stiffness").in_total);
  const double added = bent->TotalCovariance().trace() - budget.TotalCovariance().trace();
  EXPECT_NEAR(added, bend.squaredNorm(), 1e-4 * bend.squaredNorm());
}

// The tip as the tracker has it once it corrected the bend by a measured force and a stiffness.
TEST_F(ErrorBudget, ACorrectedBendLeavesWhatForceAndStiffnessAreOff) {
  const TipBending bending{.f_R = {1.2, -0.8, 2.0},
                           .stiffness_Nm2 = 0.02,
                           .stiffness_sd_Nm2 = 0.0008,
                           .corrected = true,
                           .force_noise_N = 0.06};
  const auto claimed = BudgetOfTip(camera, collar, tags, {}, bending);
  ASSERT_TRUE(claimed);
  EXPECT_FALSE(Part(*claimed, "bending").in_total);
  const Pose T_RE = camera.T_RC * kT_CE;
  const FreeEnd end{0.0275, bending.stiffness_Nm2, {}};
  const Eigen::Vector3d truth = BendFreeEnd(end, bending.f_R, T_RE).p;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 400;
  for (int i = 0; i < kDraws; ++i) {
    FreeEnd drawn = end;
    drawn.bending_stiffness_Nm2 += bending.stiffness_sd_Nm2 * normal(random);
    const Eigen::Vector3d f =
        bending.f_R + bending.force_noise_N * Draw(Eigen::Matrix3d::Identity());
    const Eigen::Vector3d error = BendFreeEnd(drawn, f, T_RE).p - truth;
    spread += error * error.transpose() / kDraws;
  }
  ExpectSpread(spread,
               Part(*claimed, "load").covariance_R + Part(*claimed, "stiffness").covariance_R,
               budget.depth_R);
  const Eigen::Matrix3d rest = claimed->TotalCovariance() - Part(*claimed, "pixels").covariance_R;
  EXPECT_LT((rest - Part(*claimed, "load").covariance_R - Part(*claimed, "stiffness").covariance_R)
                .norm(),
            1e-12 * rest.norm());
}

}  // namespace
}  // namespace flextip
