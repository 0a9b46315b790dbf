// Orientations as tables give them.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <optional>
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

bool IsAxis(const std::string& axis);  ///< x, -x, y, -y, z, -z
/// The frame whose x axis is `axis` of the given one, its y and z the next two of them (z: z, x, y;
/// -z: -z, -x, y). Empty for x and for no axis: the frame stays as it is.
std::optional<Eigen::Quaterniond> FrameAlong(const std::string& axis);

}  // namespace flextip::exchange
