#include "arms/held_shaft/carried_wrist.h"

#include <algorithm>

#include "core/rotation.h"

namespace flextip::arms {
namespace {

using namespace diagnosis::sample_input;

}  // namespace

Where WhereAt(const Track& track, double t_s) {
  const Eigen::VectorXd& t = track.t_s;
  const auto after = std::upper_bound(t.begin(), t.end(), t_s);
  const auto row = Eigen::Index(after - t.begin()) - 1;
  if (row < 0) return {0, 0.0};
  if (row + 1 >= t.size()) return {t.size() - 1, 0.0};
  return {row, (t_s - t[row]) / (t[row + 1] - t[row])};
}

WristByJoints::WristByJoints(const ArmData& data, const Kinematics& kinematics,
                             const Eigen::VectorXd& q) {
  const std::vector<LinkPlace> places = kinematics.Places(q);
  T_RW = data.arm.T_LK ? places.back().T * *data.arm.T_LK : places.back().T;
  J = kinematics.Jacobian(places, data.Size() - 1, T_RW.p);
}

WristByJoints::WristByJoints(const ArmData& data, const Eigen::VectorXd& q)
    : WristByJoints(data, data.nominal, q) {}

Where CarriedWrist::At(const diagnosis::Instant& now) const {
  return WhereAt(arm_->data.joints, arm_->wrist_starts_s + now.t_s);
}

WristMove::WristMove(const WristByJoints& from, const WristByJoints& to,
                     diagnosis::InputChange& change)
    : change_(change) {
  const Eigen::Vector3d place = to.T_RW.p - from.T_RW.p;
  const Eigen::Vector3d turn = LogRotation(to.T_RW.R * from.T_RW.R.transpose());
  by_turn_ = LeftJacobian(turn).inverse();
  for (int i = 0; i < 3; ++i) {
    change_.Add(kWrist + i, place[i]);
    change_.Add(kWristReadTurn + i, -turn[i]);
  }
}

void WristMove::Derivative(int j, const Eigen::Matrix<double, 6, 1>& twist) {
  const Eigen::Vector3d turn = by_turn_ * twist.tail<3>();
  for (int i = 0; i < 3; ++i) {
    change_.Derivative(j, kWrist + i, twist[i]);
    change_.Derivative(j, kWristReadTurn + i, -turn[i]);
  }
}

std::vector<diagnosis::ReportedParameter> AsReported(const std::vector<ArmParameter>& parameters) {
  std::vector<diagnosis::ReportedParameter> reported;
  reported.reserve(parameters.size());
  for (const ArmParameter& p : parameters) reported.push_back({p.name, p.value, p.sd, false});
  return reported;
}

}  // namespace flextip::arms
