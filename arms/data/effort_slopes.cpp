#include "arms/data/effort_slopes.h"

#include "arms/model/dynamics.h"

namespace flextip::arms {
namespace {

constexpr double kStep = 1e-4;  // rad or m

Eigen::VectorXd StatedNumbers(const Arm& arm) {
  Eigen::VectorXd numbers(kLinkNumbers * arm.Size());
  for (int i = 0; i < arm.Size(); ++i)
    numbers.segment(kLinkNumbers * i, kLinkNumbers) = NumbersOf(arm.links[std::size_t(i)]);
  return numbers;
}

Eigen::VectorXd Effort(const ArmData& data, const Kinematics& arm, const Where& where,
                       const Eigen::VectorXd& joints, const Eigen::VectorXd& numbers) {
  const Motion motion{At(data.smooth, where).transpose() + joints, At(data.rate, where).transpose(),
                      At(data.acceleration, where).transpose()};
  return EffortRegressor(arm, motion, data.gravity_m_s2) * numbers;
}

}  // namespace

Eigen::MatrixXd StatedEffort(const ArmData& data) {
  const Eigen::VectorXd numbers = StatedNumbers(data.arm),
                        none = Eigen::VectorXd::Zero(data.Size());
  Eigen::MatrixXd effort(data.torque.track.Rows(), data.torque.track.values.cols());
  for (Eigen::Index k = 0; k < effort.rows(); ++k)
    effort.row(k) = Effort(data, data.nominal, data.torque.where[std::size_t(k)], none, numbers)
                        .head(effort.cols())
                        .transpose();
  return effort;
}

EffortSlopes SlopesOf(const ArmData& data) {
  EffortSlopes slopes;
  if (!data.torque.Any() || data.arm.links.empty() || !data.has_encoders) return slopes;
  if (!data.seen.Any() && !data.pose.Any()) return slopes;
  const int n = data.Size();
  const Eigen::Index rows = data.torque.track.Rows(), measured = data.torque.track.values.cols();
  const Eigen::VectorXd numbers = StatedNumbers(data.arm), none = Eigen::VectorXd::Zero(n);
  const auto slope = [&](const Kinematics& up, const Kinematics& down, const Eigen::VectorXd& by) {
    Eigen::MatrixXd shape(rows, measured);
    for (Eigen::Index k = 0; k < rows; ++k) {
      const Where& where = data.torque.where[std::size_t(k)];
      shape.row(k) =
          ((Effort(data, up, where, by, numbers) - Effort(data, down, where, -by, numbers)) /
           (2.0 * kStep))
              .head(measured)
              .transpose();
    }
    return shape;
  };
  for (int j = 0; j < n; ++j)
    slopes.by_joint.push_back(
        slope(data.nominal, data.nominal, kStep * Eigen::VectorXd::Unit(n, j)));
  for (int j = 0; j < 3 * n; ++j) {
    const Eigen::VectorXd by = kStep * Eigen::VectorXd::Unit(3 * n, j);
    slopes.by_geometry.push_back(slope(Kinematics(data.arm, by), Kinematics(data.arm, -by), none));
  }
  return slopes;
}

}  // namespace flextip::arms
