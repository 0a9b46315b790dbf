// Efforts as the replay predicts them: those of the stated masses where joints and links truly are,
// and all shapes that are linear in parameters.
#include "arms/replay/replay.h"

namespace flextip::arms {

void Replay::AddEffortSlopes(Channel& channel, const std::vector<JointStage::Column>& columns,
                             Eigen::MatrixXd& predicted) const {
  const int r = channel.recording;
  const ArmData& data = layout_.Recordings()[r];
  const EffortSlopes& slopes = effort_slopes_[r];
  if (slopes.by_joint.empty()) return;
  const Eigen::Index n = channel.Components();
  const Eigen::MatrixXd moved = joints_[r] - data.joints.values;
  for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
    const Eigen::RowVectorXd by = At(moved, channel.where[k]);
    for (int j = 0; j < data.Size(); ++j) predicted.row(k) += by[j] * slopes.by_joint[j].row(k);
  }
  const PoseStage stage = ActOnPose(r);
  for (int j = 0; j < 3 * data.Size(); ++j) {
    const double by = stage.values[PoseStage::kGeometry + j];
    if (by != 0.0) predicted += by * slopes.by_geometry[j];
  }
  if (!derivatives_) return;
  for (const auto& column : columns)
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      channel.derivative.block(k * n, column.parameter, n, 1) +=
          At(column.values, channel.where[k]) * slopes.by_joint[column.joint].row(k).transpose();
  for (const PoseStage::Moved& of : stage.moved)
    for (Eigen::Index k = 0; of.slot >= PoseStage::kGeometry && k < channel.Rows(); ++k)
      channel.derivative.block(k * n, of.parameter, n, 1) +=
          slopes.by_geometry[of.slot - PoseStage::kGeometry].row(k).transpose();
}

void Replay::FillTorque(Channel& channel, const std::vector<JointStage::Column>& columns) const {
  const int r = channel.recording;
  const ArmData& data = layout_.Recordings()[r];
  const Eigen::Index n = channel.Components();
  Eigen::MatrixXd predicted = base_effort_[r];
  if (derivatives_) channel.derivative.setZero();
  for (const EffortStage::Column& column : efforts_[r].columns) {
    if (theta_[column.parameter] != 0.0) predicted += theta_[column.parameter] * column.shape;
    for (Eigen::Index k = 0; derivatives_ && k < channel.Rows(); ++k)
      channel.derivative.block(k * n, column.parameter, n, 1) = column.shape.row(k).transpose();
  }
  AddEffortSlopes(channel, columns, predicted);
  channel.residual = data.torque.track.values - predicted;
}

}  // namespace flextip::arms
