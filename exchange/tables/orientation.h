// Orientations as tables give them.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace flextip::exchange {

/// The roles of a kind's columns in the order that OrientationOf takes their values.
const std::vector<std::string>& OrientationRoles(const std::string& kind);

struct OrientationRead {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  std::string problem;  ///< "found ..., expected ..."; empty where it is a rotation
};
/// `kind`: quaternion, matrix (row by row), rotation-vector, or euler-abc: R = Ra Rb Rc, angles
/// about x, y, z in `values`. A unit quaternion stays as it is, bit for bit.
OrientationRead OrientationOf(const std::string& kind, const std::vector<double>& values);

}  // namespace flextip::exchange
