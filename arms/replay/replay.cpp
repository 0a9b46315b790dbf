#include "arms/replay/replay.h"

#include <fmt/format.h>

#include <cmath>

#include "arms/effects/marker.h"
#include "arms/replay/registration.h"

namespace flextip::arms {
namespace {

constexpr double kCommandStep = 1e-4;  // of a command effect's number, in s or rad/Nm

std::vector<std::string> JointNames(const ArmData& data, Eigen::Index count) {
  std::vector<std::string> names;
  names.reserve(std::size_t(count));
  for (int i = 0; i < int(count); ++i)
    names.push_back(fmt::format("q{}_{}", i + 1, UnitOf(data.arm.joints[i].type)));
  return names;
}

std::vector<std::string> EffortNames(const ArmData& data, Eigen::Index count) {
  std::vector<std::string> names;
  names.reserve(std::size_t(count));
  for (int i = 0; i < int(count); ++i)
    names.push_back(fmt::format("tau{}_{}", i + 1, EffortUnitOf(data.arm.joints[i].type)));
  return names;
}

Channel MakeChannel(int r, Kind kind, const Measured& measured, std::vector<std::string> components,
                    int parameters) {
  Channel channel;
  channel.recording = r;
  channel.kind = kind;
  channel.components = std::move(components);
  channel.t_s = measured.track.t_s;
  channel.where = measured.where;
  channel.stated = measured.noise;
  const auto columns = Eigen::Index(channel.components.size());
  channel.residual.setZero(measured.track.Rows(), columns);
  channel.derivative.setZero(measured.track.Rows() * columns, parameters);
  return channel;
}

}  // namespace

const char* Name(Kind kind) {
  switch (kind) {
    case Kind::kFollowed:
      return "joints0";
    case Kind::kSeen:
      return "joints_seen0";
    case Kind::kPose:
      return "pose0";
    case Kind::kTorque:
      return "torque0";
  }
  return "";
}

Replay::Replay(const Layout& layout)
    : layout_(layout), theta_(Eigen::VectorXd::Zero(layout.Size())) {
  const auto& recordings = layout.Recordings();
  registered_.resize(recordings.size());
  joints_.resize(recordings.size());
  efforts_.resize(recordings.size());
  base_effort_.resize(recordings.size());
  effort_slopes_.resize(recordings.size());
  for (int r = 0; r < int(recordings.size()); ++r) {
    const ArmData& data = recordings[r];
    const int P = layout.Size(), n = data.Size();
    const auto add = [&](Kind kind, const Measured& measured, std::vector<std::string> names) {
      if (measured.Any()) channels_.push_back(MakeChannel(r, kind, measured, std::move(names), P));
    };
    add(Kind::kFollowed, data.followed, JointNames(data, n));
    add(Kind::kSeen, data.seen, JointNames(data, n));
    add(Kind::kPose, data.pose, {"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"});
    if (data.torque.Any())
      add(Kind::kTorque, data.torque, EffortNames(data, data.torque.track.values.cols()));
    if (data.arm.T_LK) registered_[r].T_LK = *data.arm.T_LK;
    if (!data.torque.Any()) continue;
    EachEffect(r, [&](const Layout::Block& block) {
      efforts_[r].first = block.first;
      block.effect->ActOnEffort(data, efforts_[r]);
    });
    base_effort_[r].setZero(data.torque.track.Rows(), data.torque.track.values.cols());
    if (data.arm.links.empty()) continue;
    base_effort_[r] = StatedEffort(data);
    effort_slopes_[r] = SlopesOf(data);
  }
}

Channel* Replay::Find(int r, Kind kind) {
  for (Channel& channel : channels_)
    if (channel.recording == r && channel.kind == kind) return &channel;
  return nullptr;
}

void Replay::Evaluate(const Eigen::VectorXd& theta, bool with_derivatives) {
  theta_ = theta;
  derivatives_ = with_derivatives;
  for (int r = 0; r < int(layout_.Recordings().size()); ++r) EvaluateRecording(r, with_derivatives);
}

Eigen::MatrixXd Replay::CommandOutput(int r, const Eigen::VectorXd& theta) const {
  const ArmData& data = layout_.Recordings()[r];
  Eigen::MatrixXd output = data.command.values;
  EachEffect(r, [&](const Layout::Block& block) {
    JointStage stage(data.command, data.effort_at_command, output, nullptr);
    block.effect->ActOnCommand(data, theta.data() + block.first, stage);
  });
  return output;
}

std::vector<Eigen::MatrixXd> Replay::CommandDerivatives(int r, std::vector<int>& parameters) const {
  const ArmData& data = layout_.Recordings()[r];
  std::vector<Eigen::MatrixXd> derivatives;
  EachEffect(r, [&](const Layout::Block& block) {
    // Effects that act on commands are found by acting.
    Eigen::MatrixXd output = data.command.values;
    const Eigen::VectorXd moved = Eigen::VectorXd::Constant(block.size, kCommandStep);
    JointStage stage(data.command, data.effort_at_command, output, nullptr);
    block.effect->ActOnCommand(data, moved.data(), stage);
    if (output == data.command.values) return;
    for (int j = block.first; j < block.first + block.size; ++j) {
      Eigen::VectorXd up = theta_, down = theta_;
      up[j] += kCommandStep;
      down[j] -= kCommandStep;
      derivatives.emplace_back((CommandOutput(r, up) - CommandOutput(r, down)) /
                               (2 * kCommandStep));
      parameters.push_back(j);
    }
  });
  return derivatives;
}

Replay::Stage Replay::JointOutput(int r, const Track& input, const Eigen::VectorXd& theta,
                                  bool with_derivatives) const {
  const ArmData& data = layout_.Recordings()[r];
  Stage result{input.values, {}};
  JointStage stage(input, data.effort_at_joints, result.output,
                   with_derivatives ? &result.columns : nullptr);
  EachEffect(r, [&](const Layout::Block& block) {
    stage.SetFirst(block.first);
    block.effect->StartPlay(data, theta.data() + block.first, stage);
  });
  EachEffect(r, [&](const Layout::Block& block) {
    stage.SetFirst(block.first);
    block.effect->ActOnJoints(data, theta.data() + block.first, stage);
  });
  return result;
}

void Replay::EvaluateRecording(int r, bool with_derivatives) {
  const ArmData& data = layout_.Recordings()[r];
  std::vector<JointStage::Column> columns;
  std::vector<int> parameters;
  std::vector<Eigen::MatrixXd> by_command;
  Eigen::MatrixXd followed;
  const bool moving = data.has_command && !data.at_stops;
  if (moving) {
    followed = CommandOutput(r, theta_);
    if (with_derivatives) by_command = CommandDerivatives(r, parameters);
  }
  if (Channel* channel = Find(r, Kind::kFollowed)) {
    for (std::size_t p = 0; p < parameters.size(); ++p)
      for (int i = 0; i < data.Size(); ++i)
        columns.push_back({parameters[p], i, by_command[p].col(i)});
    FillJoints(*channel, data.followed, followed, columns);
    columns.clear();
  }
  Track input = data.joints;
  if (!data.has_encoders && moving) input.values = followed;
  Stage stage = JointOutput(r, input, theta_, with_derivatives);
  joints_[r] = stage.output;
  for (std::size_t p = 0; !data.has_encoders && p < parameters.size(); ++p) {
    constexpr double h = 1e-4;
    Track up = input, down = input;
    up.values += h * by_command[p];
    down.values -= h * by_command[p];
    const Eigen::MatrixXd by =
        (JointOutput(r, up, theta_, false).output - JointOutput(r, down, theta_, false).output) /
        (2 * h);
    for (int i = 0; i < data.Size(); ++i) stage.columns.push_back({parameters[p], i, by.col(i)});
  }
  if (Channel* channel = Find(r, Kind::kSeen))
    FillJoints(*channel, data.seen, stage.output, stage.columns);
  if (Channel* channel = Find(r, Kind::kPose)) FillPose(*channel, stage.columns);
  if (Channel* channel = Find(r, Kind::kTorque)) FillTorque(*channel, stage.columns);
}

void Replay::FillJoints(Channel& channel, const Measured& measured, const Eigen::MatrixXd& output,
                        const std::vector<JointStage::Column>& columns) const {
  const Eigen::Index n = channel.Components();
  for (Eigen::Index k = 0; k < channel.Rows(); ++k)
    channel.residual.row(k) = measured.track.values.row(k) - At(output, measured.where[k]);
  if (!derivatives_) return;
  channel.derivative.setZero();
  for (const auto& column : columns) {
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      channel.derivative(k * n + column.joint, column.parameter) +=
          At(column.values, measured.where[k]);
  }
}

void Replay::Register() {
  for (int r = 0; r < int(registered_.size()); ++r) {
    const ArmData& data = layout_.Recordings()[r];
    if (!data.pose.Any() || !TrackerIsUnknown(data)) continue;
    std::vector<Pose> arm, seen;
    std::vector<Eigen::Vector3d> arm_points, seen_points;
    for (Eigen::Index k = 0; k < data.pose.track.Rows(); ++k) {
      const auto z = data.pose.track.values.row(k);
      const Pose T_RL = data.nominal.Last(At(joints_[r], data.pose.where[k]).transpose());
      arm_points.push_back(T_RL * registered_[r].T_LK.p);
      seen_points.emplace_back(z.head<3>().transpose());
      if (!std::isfinite(z[3])) continue;
      arm.push_back(T_RL);
      seen.push_back(
          Pose::FromQuaternion({z[3], z[4], z[5], z[6]}, Eigen::Vector3d(z.head<3>().transpose())));
    }
    if (const auto places = FindPlaces(arm, seen, MarkerIsUnknown(data), registered_[r].T_LK)) {
      registered_[r] = {places->T_TR, places->T_LK};
    } else if (const auto tracker = FindTracker(arm_points, seen_points)) {
      registered_[r].T_TR = *tracker;
    }
  }
}

}  // namespace flextip::arms
