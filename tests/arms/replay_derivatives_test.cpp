// Every parameter's derivative in every channel against differences of the replay.
#include <gtest/gtest.h>

#include "arms/replay/replay.h"
#include "core/rotation.h"
#include "tests/arms/made_arm.h"

namespace flextip::arms {
namespace {

/// Of what was measured.
double Largest(const Eigen::MatrixXd& residual) {
  return residual.array().isFinite().select(residual.array().abs(), 0.0).maxCoeff();
}

/// Compares all derivatives at parameters of typical size. With `carried` joints drag each other:
/// a play may end between two of the places that are compared.
void ExpectDerivatives(const Recording& recording, bool carried = false) {
  const std::vector<ArmData> data{ArmData(recording, "made")};
  const Layout layout(data, {});
  Replay replay(layout);
  Eigen::VectorXd theta(layout.Size());
  for (int j = 0; j < layout.Size(); ++j) {
    const auto& p = layout.Prior().Parameter(j);
    theta[j] = (p.positive || j % 2 == 0 ? 0.3 : -0.3) * std::max(p.typical, p.tolerance * 0.1);
  }
  if (layout.WindowBlock() >= 0) {
    const Layout::Block& play = layout.Blocks()[layout.WindowBlock()];
    play.effect->SetHistory({Eigen::VectorXd::Constant(data[0].Size(), 0.01), {}});
    if (carried) {
      Eigen::VectorXd own = theta.segment(play.first, play.size);
      PlayHistory history = play.effect->Carrying(data[0], own);
      history.by_parameters = true;
      play.effect->SetHistory(history);
    }
  }
  replay.Evaluate(theta);
  const std::vector<Channel> at = replay.Channels();
  for (int j = 0; j < layout.Size(); ++j) {
    const double h = 1e-3 * std::abs(theta[j]) + 1e-9;
    Eigen::VectorXd up = theta, down = theta;
    up[j] += h;
    down[j] -= h;
    Replay moved = replay;
    moved.Evaluate(up, false);
    const std::vector<Channel> above = moved.Channels();
    moved.Evaluate(down, false);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Eigen::MatrixXd by = (moved.Channels()[i].residual - above[i].residual) / (2 * h);
      double largest = 1e-6, worst = 0.0;
      for (Eigen::Index k = 0; k < by.rows(); ++k)
        for (Eigen::Index c = 0; c < by.cols(); ++c) {
          const double own = at[i].derivative(k * by.cols() + c, j);
          largest = std::max(largest, std::abs(by(k, c)));
          worst = std::max(worst, std::abs(own - by(k, c)));
        }
      // Differences of large numbers are rounded.
      const double rounded = 1e-15 / h * Largest(above[i].residual);
      EXPECT_LT(worst, (carried ? 4e-4 : 2e-4) * largest + rounded)
          << Name(at[i].kind) << " by parameter " << j;
    }
  }
}

TEST(ArmReplay, DerivativesOfSeenJointsFromCommands) {
  Recording recording = ArmRecording(SixJoints());
  recording.joints_command0 = SmoothMotion(*recording.arm, 60, 50.0, 1);
  recording.joints_seen0 = recording.joints_command0;
  ExpectDerivatives(recording);
}

TEST(ArmReplay, DerivativesOfPlaysThatDragEachOther) {
  Recording recording = ArmRecording(SixJoints());
  recording.joints_command0 = SmoothMotion(*recording.arm, 60, 50.0, 1);
  recording.joints_seen0 = recording.joints_command0;
  ExpectDerivatives(recording, true);
}

TEST(ArmReplay, DerivativesOfPosesAndFollowedJoints) {
  Recording recording = ArmRecording(SixJoints());
  recording.arm->T_LK = Pose{ExpRotation({0.2, 0.1, 0.4}), {0.01, 0.02, 0.03}};
  recording.joints_command0 = SmoothMotion(*recording.arm, 40, 50.0, 2);
  recording.joints0 = recording.joints_command0;
  PoseStream pose;
  const Kinematics arm(*recording.arm);
  for (const auto& sample : recording.joints0->q) {
    const Pose T = arm.Last(sample.value) * *recording.arm->T_LK;
    pose.samples.push_back({sample.t_ns, {T.p, T.Quaternion()}});
  }
  pose.position_noise_m = 1e-4;
  pose.orientation_noise_rad = 1e-3;
  recording.pose0 = pose;
  ExpectDerivatives(recording);
}

TEST(ArmReplay, DerivativesOfEfforts) {
  Recording recording = ArmRecording(ThreeJointsWithMasses());
  recording.joints0 = SmoothMotion(*recording.arm, 60, 50.0, 3);
  TorqueStream torque;
  torque.types = recording.joints0->types;
  torque.noise.assign(3, 0.01);
  for (const auto& sample : recording.joints0->q)
    torque.tau.push_back({sample.t_ns, Eigen::Vector3d(1.0, 2.0, 3.0)});
  recording.torque0 = torque;
  ExpectDerivatives(recording);
}

TEST(ArmReplay, DerivativesOfEffortsOfMovedJointsAndLinks) {
  Recording recording = ArmRecording(ThreeJointsWithMasses());
  recording.joints0 = SmoothMotion(*recording.arm, 60, 50.0, 3);
  recording.joints_seen0 = recording.joints0;
  recording.arm->T_LK = Pose{};
  TorqueStream torque;
  torque.types = recording.joints0->types;
  torque.noise.assign(3, 0.01);
  PoseStream pose;
  pose.position_noise_m = 1e-4;
  pose.orientation_noise_rad = 1e-3;
  const Kinematics arm(*recording.arm);
  for (const auto& sample : recording.joints0->q) {
    torque.tau.push_back({sample.t_ns, Eigen::Vector3d(1.0, 2.0, 3.0)});
    const Pose T = arm.Last(sample.value);
    pose.samples.push_back({sample.t_ns, {T.p, T.Quaternion()}});
  }
  recording.torque0 = torque;
  recording.pose0 = pose;
  ExpectDerivatives(recording);
}

}  // namespace
}  // namespace flextip::arms
