#include "simulation/plant/shape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/check.h"
#include "core/rotation.h"

namespace flextip::simulation {
namespace {

/// Cubic Lagrange interpolation of `values[first .. first + count)`, given at 0, 1, 2, ..., at `x`.
Eigen::Vector3d Cubic(const std::vector<Eigen::Vector3d>& values, int first, int count, double x) {
  const int start = std::clamp(static_cast<int>(std::floor(x)) - 1, 0, count - 4);
  const double u = x - start;
  const std::array<double, 4> weight = {-(u - 1) * (u - 2) * (u - 3) / 6, u * (u - 2) * (u - 3) / 2,
                                        -u * (u - 1) * (u - 3) / 2, u * (u - 1) * (u - 2) / 6};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) sum += weight[k] * values[first + start + k];
  return sum;
}

}  // namespace

const char* Name(PlantStatus status) {
  switch (status) {
    case PlantStatus::kOk:
      return "ok";
    case PlantStatus::kBadInput:
      return "bad input";
    case PlantStatus::kUnreachable:
      return "unreachable";
    case PlantStatus::kNotConverged:
      return "not converged";
  }
  return "";
}

PlantShape::Part PlantShape::PartAt(double s_m) const {
  FLEXTIP_CHECK(IsUsable() && s_m >= -1e-9 && s_m <= length_m + 1e-9, "a place on a solved shaft");
  return parts_[s_m < s_port_m ? 0 : 1];
}

Eigen::Vector3d PlantShape::Position(double s_m) const {
  const Part part = PartAt(s_m);
  return Cubic(nodes_, part.first, part.links + 1, (s_m - part.s_begin) / part.h);
}

Eigen::Vector3d PlantShape::Moment(double s_m) const {
  const Part part = PartAt(s_m);
  return Cubic(moments_, part.first_moment, part.links + 1, (s_m - part.s_begin) / part.h);
}

Eigen::Vector3d PlantShape::Tangent(double s_m) const {
  const Part part = PartAt(s_m);  // a link's direction is the tangent at its middle
  return Cubic(directions_, part.first, part.links, (s_m - part.s_begin) / part.h - 0.5)
      .normalized();
}

Pose PlantShape::Frame(double s_m) const {
  const Part part = PartAt(s_m);
  const int in_part =
      std::clamp(static_cast<int>((s_m - part.s_begin) / part.h), 0, part.links - 1);
  const int link = part.first + in_part;
  const Eigen::Matrix3d R = RotationWithoutTwist(directions_[link], Tangent(s_m)) * frames_[link];
  if (twists_1_m_.empty()) return {R, Position(s_m)};
  const double past_middle = s_m - part.s_begin - (in_part + 0.5) * part.h;
  return {R * ExpRotation(past_middle * twists_1_m_[link] * Eigen::Vector3d::UnitX()),
          Position(s_m)};
}

ShaftCurve PlantShape::Curve() const { return {nodes_, diameter_m, T_RE()}; }

}  // namespace flextip::simulation
