#include "arms/diagnose/side_view.h"

#include <algorithm>

#include "arms/model/kinematics.h"
#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

constexpr double kApart = 0.05;  // of the arm's size

/// The last direction first: along x where there is none.
Eigen::Vector2d DirectionOf(const Eigen::Vector2d& way) {
  const double length = way.norm();
  return length > 0.0 ? Eigen::Vector2d(way / length) : Eigen::Vector2d::UnitX();
}

}  // namespace

std::vector<Eigen::Vector2d> SideView(const ArmData& data) {
  const Eigen::VectorXd q = data.joints.values.row(data.joints.Rows() / 2);
  std::vector<Eigen::Vector3d> points{data.arm.T_RB.p};
  for (const LinkPlace& place : Kinematics(data.arm).Places(q)) points.push_back(place.T.p);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / double(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const SymmetricEigen<3> axes(spread);
  const Eigen::Vector3d x = axes.vectors.col(2), y = axes.vectors.col(1);
  std::vector<Eigen::Vector2d> view;
  double size = 0.0;
  for (const Eigen::Vector3d& p : points) {
    view.emplace_back(x.dot(p), y.dot(p));
    size = std::max(size, (view.back() - view.front()).norm());
  }
  if (size == 0.0) size = 1.0;
  std::vector<Eigen::Vector2d> apart{view.front()};
  for (std::size_t i = 1; i < view.size(); ++i) {
    Eigen::Vector2d p = view[i];
    if ((p - apart.back()).norm() < kApart * size) {
      const Eigen::Vector2d next = i + 1 < view.size() ? view[i + 1] - view[i] : view[i] - view[0];
      p = apart.back() + kApart * size * DirectionOf(next);
    }
    apart.push_back(p);
  }
  return apart;
}

}  // namespace flextip::arms
