// Outside poses as the replay predicts them, and how joints, links, tracker and marker move them.
#include <cmath>

#include "arms/effects/marker.h"
#include "arms/replay/replay.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip::arms {

PoseStage Replay::ActOnPose(int r) const {
  const ArmData& data = layout_.Recordings()[r];
  PoseStage stage(data.Size());
  EachEffect(r, [&](const Layout::Block& block) {
    stage.first = block.first;
    block.effect->ActOnPose(data, theta_.data() + block.first, stage);
  });
  return stage;
}

void Replay::FillPose(Channel& channel, const std::vector<JointStage::Column>& columns) const {
  const int r = channel.recording;
  const ArmData& data = layout_.Recordings()[r];
  const PoseStage stage = ActOnPose(r);
  const Eigen::VectorXd& v = stage.values;
  const Eigen::VectorXd geometry = v.tail(3 * data.Size());
  const Kinematics arm = geometry.isZero(0.0) ? data.nominal : Kinematics(data.arm, geometry);
  const Eigen::Vector3d turn = v.segment<3>(PoseStage::kTrackerRotation);
  const Registered& base = registered_[r];
  const Eigen::Matrix3d tracker_turn = ExpRotation(turn), by_turn = LeftJacobian(turn);
  const Pose T_TR{tracker_turn * base.T_TR.R,
                  tracker_turn * base.T_TR.p + v.segment<3>(PoseStage::kTracker)};
  const Eigen::Vector3d mark = v.segment<3>(PoseStage::kMarkerRotation);
  const Eigen::Matrix3d by_mark = LeftJacobian(mark);
  const Pose T_LK{ExpRotation(mark) * base.T_LK.R, base.T_LK.p + v.segment<3>(PoseStage::kMarker)};
  if (derivatives_) channel.derivative.setZero();
  const int last = data.Size() - 1;
  for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
    const Where& where = channel.where[k];
    const auto places = arm.Places(At(joints_[r], where).transpose());
    const Pose& T_RL = places[last].T;
    const Eigen::Vector3d p_RK = T_RL * T_LK.p, p_TK = T_TR * p_RK;
    const Eigen::Matrix3d R_TK = T_TR.R * T_RL.R * T_LK.R;
    const auto z = data.pose.track.values.row(k);
    channel.residual.row(k).head<3>() = z.head<3>() - p_TK.transpose();
    const bool turned = std::isfinite(z[3]);
    if (turned) {
      const Eigen::Quaterniond q(z[3], z[4], z[5], z[6]);
      channel.residual.row(k).tail<3>() =
          LogRotation(q.toRotationMatrix() * R_TK.transpose()).transpose();
    } else {
      channel.residual.row(k).tail<3>().setConstant(std::nan(""));
    }
    if (!derivatives_) continue;
    Eigen::MatrixXd turn6(6, 6);
    turn6 << T_TR.R, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), T_TR.R;
    const Eigen::MatrixXd J = turn6 * arm.Jacobian(places, last, p_RK);
    auto rows = channel.derivative.middleRows(6 * k, 6);
    for (const auto& column : columns)
      rows.col(column.parameter) += At(column.values, where) * J.col(column.joint);
    Eigen::MatrixXd G;
    for (const PoseStage::Moved& moved : stage.moved) {
      Eigen::Matrix<double, 6, 1> by = Eigen::Matrix<double, 6, 1>::Zero();
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(moved.slot % 3);
      if (moved.slot < PoseStage::kTracker) {
        const Eigen::Vector3d w = by_turn * unit;
        by << w.cross(p_TK - v.segment<3>(PoseStage::kTracker)), w;
      } else if (moved.slot < PoseStage::kMarkerRotation) {
        by.head<3>() = unit;
      } else if (moved.slot < PoseStage::kMarker) {
        by.tail<3>() = T_TR.R * T_RL.R * by_mark * unit;
      } else if (moved.slot < PoseStage::kGeometry) {
        by.head<3>() = T_TR.R * T_RL.R * unit;
      } else {
        if (G.size() == 0) G = turn6 * arm.GeometryJacobian(places, last, p_RK);
        by = G.col(moved.slot - PoseStage::kGeometry);
      }
      rows.col(moved.parameter) += by;
    }
    if (!turned) continue;
    // A turn of the prediction moves the residual's vector by the inverse of its own Jacobian.
    const Eigen::Vector3d left = channel.residual.row(k).tail<3>().transpose();
    rows.bottomRows<3>() = Lu(LeftJacobian(-left)).Solve(rows.bottomRows<3>());
  }
}

}  // namespace flextip::arms
