// The outline beside the tags and alone, the pose beside the truth of rendered frames.
#include "vision/outline/tip_outline.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"

#include <gtest/gtest.h>

#include <random>

#include "core/rotation.h"
#include "tests/vision/outline_scene.h"
#include "tests/vision/scope_scene.h"
#include "vision/outline/contour.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

ContourOptions RingLight() {
  ContourOptions options;
  options.errors = ContourErrors::LightAtLens();
  return options;
}

// Standard deviations in C's axes, as a covariance in R's.
Matrix6 Spread(const Vector6& sd_C) {
  const Matrix6 covariance_C = sd_C.cwiseAbs2().asDiagonal();
  return Turned(covariance_C, ScopeCamera().T_RC.R);
}

TipPrediction Drawn(const Pose& truth, const Matrix6& covariance, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6 z;
  for (double& x : z) x = normal(random);
  return {MovePose(truth, Llt(covariance).L() * z), covariance};
}

// As seen in the picture: out of it the outline says little.
double DirectionError(const TipPrediction& tip, const Pose& truth) {
  const Eigen::Vector3d sight = (truth.p - ScopeCamera().T_RC.p).normalized();
  const Eigen::Vector3d aside = sight.cross(truth.R.col(0)).normalized();
  return (tip.T_RE.R.col(0) - truth.R.col(0)).dot(aside);
}

// What a pose costs: its distance from `seen` and what the edges that are found from it leave.
double Cost(const Image& image, const Eigen::Vector2d& bend, const TipPrediction& seen,
            const Pose& T_RE) {
  const ShaftContour contour(CameraModel(ScopeCamera()), ScopeTube(), RingLight());
  const Vector6 off = PoseDifference(seen.T_RE, T_RE);
  return MahalanobisSquared(off, seen.covariance) +
         contour.Linearise(image, ScopeCamera().T_RC.Inverse() * T_RE, bend, 4).chi2;
}

class Outline : public testing::Test {
 protected:
  static Image Render(const CameraCalibration& camera, const Pose& T_RE,
                      const Eigen::Vector2d& bend, int frame) {
    return simulation::Laparoscope(camera, ScopeCollar(), ScopeOptions(ScopeCamera()))
        .Render(BentScopeShaft(T_RE, bend), frame);
  }
  static Pose DrawPose(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const Eigen::Vector3d offset{0.004 * unit(random), 0.004 * unit(random), 0.008 * unit(random)};
    const Eigen::Vector2d turn = DrawVector<2>(unit, random);
    return ScopePose(0.3 * turn.x(), turn.y(), offset);
  }
};

// Tags that leave the direction to some milliradians, as one short face does.
TEST_F(Outline, MakesTheDirectionBetterAndThePositionNoWorse) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const simulation::Laparoscope scope(ScopeCamera(), ScopeCollar(), ScopeOptions(ScopeCamera()));
  TipOutline outline({ScopeCamera()}, ScopeTube(), RingLight());
  Vector6 sd;
  sd << 0.006, 0.006, 0.006, 6e-5, 6e-5, 3e-4;
  constexpr int kFrames = 30;
  double before = 0, after = 0, direction_nees = 0, position_nees = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Pose truth = DrawPose(random);
    const Image image =
        scope.Render(BentScopeShaft(truth, {15 * normal(random), 15 * normal(random)}), i);
    const TipPrediction seen = Drawn(truth, Spread(sd), random);
    const auto joined = outline.Join({&image}, seen);
    ASSERT_TRUE(joined) << i;
    before += std::pow(DirectionError(seen, truth), 2) / kFrames;
    after += std::pow(DirectionError(joined->tip, truth), 2) / kFrames;
    direction_nees += DirectionNees(joined->tip, truth) / kFrames;
    const double nees =
        PositionNees(joined->tip.T_RE.p, joined->tip.covariance.bottomRightCorner<3, 3>(), truth);
    EXPECT_LT(nees, 21.1) << i;  // 99.99 %
    position_nees += nees / kFrames;
  }
  EXPECT_LT(std::sqrt(after), 0.3 * std::sqrt(before));
  EXPECT_LT(direction_nees, 2 * 1.67);  // 2 expected; 99.9 % of the mean of 30
  EXPECT_LT(position_nees, 3 * 1.52);   // 3 expected
}

// Moved by known amounts, all that the outline fixes comes back.
TEST_F(Outline, BringsAMovedPoseBack) {
  const Pose truth = ScopePose(0.1, 0.25);
  const Eigen::Vector2d bend(10, -15);
  const Image image = Render(ScopeCamera(), truth, bend, 0);
  TipOutline outline({ScopeCamera()}, ScopeTube(), RingLight());
  const Eigen::Matrix3d R_RC = ScopeCamera().T_RC.R;
  for (const double by : {-1.0, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) {  // the turn in the picture; aside along x and y of C
      Vector6 off_C = Vector6::Zero();
      off_C[2 + axis] = by * (axis == 0 ? 0.02 : 3e-4);
      Vector6 sd;  // wide only where it was moved
      sd << 1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5;
      sd[2 + axis] = std::abs(off_C[2 + axis]);
      TipPrediction seen{MovePose(truth, Turned(off_C, R_RC)), Spread(sd)};
      const auto joined = outline.Join({&image}, seen);
      ASSERT_TRUE(joined) << by << axis;
      const Vector6 left = Turned(PoseDifference(truth, joined->tip.T_RE), R_RC.transpose());
      EXPECT_LT(std::abs(left[2 + axis]), 0.1 * std::abs(off_C[2 + axis])) << by << axis;
    }
  }
}

// Away from the joined pose by three of its standard deviations, along any axis of its covariance,
// the cost has grown as a parabola does: by 9.
TEST_F(Outline, TheJoinedPoseIsTheCheapestAround) {
  const Pose truth = ScopePose(0.15, 0.3);
  const Eigen::Vector2d bend(12, 8);
  const Image image = Render(ScopeCamera(), truth, bend, 1);
  ContourOptions options = RingLight();
  options.bend_mean = bend;
  TipOutline outline({ScopeCamera()}, ScopeTube(), options);
  std::mt19937 random(8);
  Vector6 sd;
  sd << 0.004, 0.004, 0.004, 4e-5, 4e-5, 2e-4;
  const TipPrediction seen = Drawn(truth, Spread(sd), random);
  const auto joined = outline.Join({&image}, seen);
  ASSERT_TRUE(joined);
  const double here = Cost(image, bend, seen, joined->tip.T_RE);
  const SymmetricEigen axes(joined->tip.covariance);
  for (int i = 0; i < 6; ++i) {
    const Vector6 step = 3 * std::sqrt(axes.values[i]) * axes.vectors.col(i);
    for (const double sign : {-1.0, 1.0}) {
      const double grown = Cost(image, bend, seen, MovePose(joined->tip.T_RE, sign * step)) - here;
      EXPECT_GT(grown, 3) << i;
      EXPECT_LT(grown, 18) << i;
    }
  }
}

// The bend seen in the picture: what a term says of it at one pose is what is found at another.
TEST_F(Outline, TheBendsStepFollowsThePose) {
  const Pose truth = ScopePose(0.1, 0.25);
  const Eigen::Vector2d bend(20, -30);
  const Image image = Render(ScopeCamera(), truth, bend, 0);
  const ShaftContour contour(CameraModel(ScopeCamera()), ScopeTube(), RingLight());
  const Pose T_CE = ScopeCamera().T_RC.Inverse() * truth;
  const Eigen::Vector3d aside_C = T_CE.p.cross(T_CE.R.col(0)).normalized();
  const Eigen::Vector2d seen = (T_CE.R.transpose() * aside_C).tail<2>();
  const ContourTerm term = contour.Linearise(image, T_CE, bend, 4);
  EXPECT_LT(std::abs(seen.dot(term.bend_step)), 5);  // it is there
  const ContourTerm straight = contour.Linearise(image, T_CE, {0, 0}, 6);
  EXPECT_NEAR(seen.dot(straight.bend_step), seen.dot(bend + term.bend_step), 1.5);
  for (int i = 0; i < 6; ++i) {
    Vector6 off = Vector6::Zero();
    off[i] = i < 3 ? 0.004 : 1e-4;
    const ContourTerm moved = contour.Linearise(image, MovePose(T_CE, off), bend, 4);
    const double change = seen.dot(term.bend_by_pose * off);
    EXPECT_NEAR(seen.dot(moved.bend_step - term.bend_step), change, 1 + 0.1 * std::abs(change))
        << i;
  }
}

// One draw of 20 frames. Over 30 draws the mean is 3.7 for an expected 3, so the stated deviations
// are a tenth too small, and one frame of 586 is far off (19 of its deviations).
TEST_F(Outline, AloneFindsTheTipWhileTheTagsAreCovered) {
  std::mt19937 random(6);
  simulation::LaparoscopeOptions covered = ScopeOptions(ScopeCamera());
  covered.occluders = {CoverOfTheCollar(0, 1000)};
  const simulation::Laparoscope scope(ScopeCamera(), ScopeCollar(), covered);
  TipOutline outline({ScopeCamera()}, ScopeTube(), RingLight());
  Vector6 sd;  // some 7 px
  sd << 0.02, 0.02, 0.02, 0.0012, 0.0012, 0.0012;
  constexpr int kFrames = 20;
  int found = 0;
  double nees = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Pose truth = DrawPose(random);
    const Image image = scope.Render(BentScopeShaft(truth, {10, -12}), i);
    const auto tip = outline.Find({&image}, Drawn(truth, Spread(sd), random));
    if (!tip) continue;
    ++found;
    const double here = PositionNees(tip->T_RE.p, tip->covariance.bottomRightCorner<3, 3>(), truth);
    EXPECT_LT(here, 21.1) << i;
    nees += here;
  }
  EXPECT_GE(found, 14);
  EXPECT_LT(nees / found, 3 * 1.66);  // 99.9 % of the mean of 20
}

TEST_F(Outline, TwoCamerasFixTheDepthThatOneDoesNot) {
  const Pose truth = ScopePose(0.1, 0.25);
  const Image first = Render(ScopeCamera(), truth, {10, -15}, 0);
  const Image second = Render(SecondScopeCamera(), truth, {10, -15}, 0);
  TipOutline outline({ScopeCamera(), SecondScopeCamera()}, ScopeTube(), RingLight());
  Vector6 sd;
  sd << 0.02, 0.02, 0.02, 0.001, 0.001, 0.003;
  std::mt19937 random(2);
  const TipPrediction expected = Drawn(truth, Spread(sd), random);
  const auto one = outline.Find({&first, nullptr}, expected);
  const auto other = outline.Find({nullptr, &second}, expected);
  const auto both = outline.Find({&first, &second}, expected);
  ASSERT_TRUE(one && other && both);
  const auto depth_sd = [](const TipPrediction& tip) {
    return std::sqrt(Turned(tip.covariance, ScopeCamera().T_RC.R.transpose())(5, 5));
  };
  EXPECT_LT(depth_sd(*both), 0.5 * depth_sd(*one));
  EXPECT_LT((both->T_RE.p - truth.p).norm(), 2e-4);
  EXPECT_FALSE(outline.Find({nullptr, nullptr}, expected));
}

// An outline 15 px away is another's where the prediction is good to a pixel.
TEST_F(Outline, WhatIsFarFromWhereItMustBeIsNotTaken) {
  const Pose truth = ScopePose(0.1, 0.25);
  const Image image = Render(ScopeCamera(), truth, {0, 0}, 0);
  TipOutline outline({ScopeCamera()}, ScopeTube(), {});
  Vector6 off_C = Vector6::Zero();
  off_C[4] = 0.0025;
  Vector6 sd;
  sd << 0.002, 0.002, 0.002, 1.6e-4, 1.6e-4, 1.6e-4;
  const Pose away = MovePose(truth, Turned(off_C, ScopeCamera().T_RC.R));
  EXPECT_FALSE(outline.Find({&image}, {away, Spread(sd)}));
  EXPECT_TRUE(outline.Find({&image}, {away, Spread(12 * sd)}));
  // Beside the tags: two pixels off, where they are good to a tenth.
  sd << 0.002, 0.002, 0.002, 2e-5, 2e-5, 1e-4;
  const Pose beside = MovePose(truth, Turned(Vector6(off_C / 7), ScopeCamera().T_RC.R));
  EXPECT_FALSE(outline.Join({&image}, {beside, Spread(sd)}));
  EXPECT_TRUE(outline.Join({&image}, {truth, Spread(sd)}));
}

}  // namespace
}  // namespace flextip
