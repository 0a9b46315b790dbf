// Forward kinematics against matrices written out, derivatives against differences.
#include "arms/model/kinematics.h"

#include <gtest/gtest.h>

#include "core/derivative_check.h"
#include "core/rotation.h"
#include "tests/arms/made_arm.h"

namespace flextip::arms {
namespace {

Eigen::Matrix4d About(char axis, double angle) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 'x') T.topLeftCorner<3, 3>() << 1, 0, 0, 0, c, -s, 0, s, c;
  if (axis == 'z') T.topLeftCorner<3, 3>() << c, -s, 0, s, c, 0, 0, 0, 1;
  return T;
}

Eigen::Matrix4d Along(double x, double z) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T(0, 3) = x;
  T(2, 3) = z;
  return T;
}

const Eigen::VectorXd kJoints = (Eigen::VectorXd(6) << 0.3, -0.4, 0.12, 0.7, -0.2, 0.5).finished();

TEST(ArmKinematics, AreThoseOfModifiedDenavitHartenberg) {
  const Arm arm = SixJoints();
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 6; ++i) {
    const ArmJoint& j = arm.joints[i];
    const bool turns = j.type == JointType::kRevolute;
    T = T * About('x', j.alpha_rad) * Along(j.a_m, 0) *
        About('z', j.theta_rad + (turns ? kJoints[i] : 0.0)) *
        Along(0, j.d_m + (turns ? 0.0 : kJoints[i]));
  }
  EXPECT_LT((Kinematics(arm).Last(kJoints).Matrix() - T).norm(), 1e-12);
}

TEST(ArmKinematics, AreThoseOfDenavitHartenberg) {
  Arm arm = SixJoints();
  arm.convention = ArmConvention::kDh;
  arm.T_RB = {ExpRotation({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  Eigen::Matrix4d T = arm.T_RB.Matrix();
  for (int i = 0; i < 6; ++i) {
    ArmJoint& j = arm.joints[i];
    PlaceJoint(arm.convention, j);
    const bool turns = j.type == JointType::kRevolute;
    T = T * About('z', j.theta_rad + (turns ? kJoints[i] : 0.0)) *
        Along(0, j.d_m + (turns ? 0.0 : kJoints[i])) * Along(j.a_m, 0) * About('x', j.alpha_rad);
  }
  EXPECT_LT((Kinematics(arm).Last(kJoints).Matrix() - T).norm(), 1e-12);
}

/// Position, and rotation about that at `at`, of the last frame.
Eigen::VectorXd PoseAbout(const Pose& at, const Pose& T) {
  Eigen::VectorXd pose(6);
  pose << T.p, LogRotation(T.R * at.R.transpose());
  return pose;
}

TEST(ArmKinematics, JacobianIsTheDerivative) {
  const Kinematics arm(SixJoints());
  const auto places = arm.Places(kJoints);
  const Pose at = places.back().T;
  const Eigen::MatrixXd J = arm.Jacobian(places, 5, at.p);
  const Eigen::MatrixXd by_differences = NumericJacobian(
      [&](const Eigen::VectorXd& q) { return PoseAbout(at, arm.Last(q)); }, kJoints, 1e-4);
  EXPECT_LT((J - by_differences).norm(), 1e-9);
}

TEST(ArmKinematics, GeometryJacobianIsTheDerivativeInBothConventions) {
  for (const ArmConvention convention : {ArmConvention::kModifiedDh, ArmConvention::kDh}) {
    Arm arm = SixJoints();
    arm.convention = convention;
    for (ArmJoint& joint : arm.joints) PlaceJoint(convention, joint);
    const Kinematics nominal(arm);
    const auto places = nominal.Places(kJoints);
    const Pose at = places.back().T;
    const Eigen::MatrixXd by_differences = NumericJacobian(
        [&](const Eigen::VectorXd& change) {
          return PoseAbout(at, Kinematics(arm, change).Last(kJoints));
        },
        Eigen::VectorXd::Zero(18), 1e-4);
    EXPECT_LT((nominal.GeometryJacobian(places, 5, at.p) - by_differences).norm(), 1e-9);
  }
}

TEST(ArmKinematics, BarOfAParallelogramKeepsItsOrientation) {
  const Kinematics arm(SixJoints());
  const PayloadPlace bar{"bar", 0, {}, 1, {0.04, 0.18}, 0.165};
  Eigen::VectorXd moved = kJoints;
  moved[1] += 0.3;
  const auto at = [&](const Eigen::VectorXd& q, double along) {
    PayloadPlace place = bar;
    place.along_m = along;
    return arm.PayloadPoint(place, q);
  };
  // The second joint swings the bar without turning it.
  const Eigen::Vector3d before = at(kJoints, 0.165) - at(kJoints, 0.0),
                        after = at(moved, 0.165) - at(moved, 0.0);
  EXPECT_NEAR(before.norm(), 0.165, 1e-12);
  EXPECT_LT((before - after).norm(), 1e-12);
  EXPECT_GT((at(moved, 0.0) - at(kJoints, 0.0)).norm(), 0.05);
}

}  // namespace
}  // namespace flextip::arms
