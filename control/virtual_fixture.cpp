#include "control/virtual_fixture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/place.h"

namespace flextip {
namespace {

/// `depth` and `normal` are known: moves along the normal to where the depth is minus the margin.
FixtureOutput AlongNormal(const Eigen::Vector3d& p, double depth, const Eigen::Vector3d& normal,
                          double margin_m) noexcept {
  const double missing = depth + margin_m;
  if (!(missing > 0.0)) return {FixtureStatus::kFree, p, depth, normal};
  return {FixtureStatus::kMoved, p + missing * normal, depth, normal};
}

bool IsGood(const Eigen::Vector3d& p, double margin_m) noexcept {
  return IsPlace(p) && margin_m >= 0.0 && margin_m <= kFarthestPlace_m;
}

bool IsUnit(const Eigen::Vector3d& v) noexcept { return std::abs(v.norm() - 1.0) <= 1e-6; }

FixtureOutput Refused(const Eigen::Vector3d& p) noexcept {
  return {FixtureStatus::kBadInput, p, 0.0, Eigen::Vector3d::Zero()};
}

}  // namespace

const char* Name(FixtureStatus status) {
  switch (status) {
    case FixtureStatus::kFree:
      return "free";
    case FixtureStatus::kMoved:
      return "moved";
    case FixtureStatus::kNotClear:
      return "not_clear";
    case FixtureStatus::kBadInput:
      return "bad_input";
  }
  return "";
}

FixtureOutput Constrain(const ForbiddenHalfSpace& region, const Eigen::Vector3d& p,
                        double margin_m) noexcept {
  if (!IsGood(p, margin_m) || !IsPlace(region.p_plane) || !IsUnit(region.normal)) {
    return Refused(p);
  }
  return AlongNormal(p, -region.normal.dot(p - region.p_plane), region.normal, margin_m);
}

FixtureOutput Constrain(const ForbiddenSphere& region, const Eigen::Vector3d& p,
                        double margin_m) noexcept {
  if (!IsGood(p, margin_m) || !IsPlace(region.p_centre) || !(region.radius_m >= 0.0) ||
      !(region.radius_m <= kFarthestPlace_m)) {
    return Refused(p);
  }
  const Eigen::Vector3d from_centre = p - region.p_centre;
  const double distance = from_centre.norm();
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();
  if (distance > 0.0) outward = from_centre / distance;
  if (!region.forbidden_outside) {
    return AlongNormal(p, region.radius_m - distance, outward, margin_m);
  }
  FixtureOutput output = AlongNormal(p, distance - region.radius_m, -outward, margin_m);
  if (margin_m > region.radius_m) {  // nowhere is far enough: the centre is the best there is
    output.status = FixtureStatus::kNotClear;
    output.p_RE_desired = region.p_centre;
  }
  return output;
}

PathGuidance::PathGuidance(std::vector<Eigen::Vector3d> points, double compliance,
                           double free_radius_m)
    : points_(std::move(points)), compliance_(compliance), free_radius_m_(free_radius_m) {
  if (points_.size() < 2) {
    throw InputError(fmt::format("a path needs two points or more, this has {}", points_.size()));
  }
  if (!(compliance >= 0.0 && compliance <= 1.0)) {
    throw InputError(fmt::format("a path's compliance is {}, not from 0 to 1", compliance));
  }
  if (!(free_radius_m >= 0.0 && free_radius_m <= kFarthestPlace_m)) {
    throw InputError(fmt::format("a path's free radius is {} m, not from 0 to {:g}", free_radius_m,
                                 kFarthestPlace_m));
  }
  s_m_.push_back(0.0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!IsPlace(points_[i])) {
      throw InputError(
          fmt::format("path point {} is not finite, or farther than {:g} m", i, kFarthestPlace_m));
    }
    if (i == 0) continue;
    const double length = (points_[i] - points_[i - 1]).norm();
    if (!(length > 0.0)) {
      throw InputError(fmt::format("path points {} and {} are the same", i - 1, i));
    }
    s_m_.push_back(s_m_.back() + length);
  }
}

GuidanceOutput PathGuidance::Guide(const Eigen::Vector3d& p) const noexcept {
  GuidanceOutput output;
  output.p_RE_desired = p;
  if (!IsPlace(p)) return output;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const double length = s_m_[i + 1] - s_m_[i];
    const Eigen::Vector3d tangent = (points_[i + 1] - points_[i]) / length;
    const double along = std::clamp(tangent.dot(p - points_[i]), 0.0, length);
    const Eigen::Vector3d place = points_[i] + along * tangent;
    const double distance2 = (p - place).squaredNorm();
    if (distance2 >= nearest2) continue;
    nearest2 = distance2;
    output.p_path = place;
    output.tangent = tangent;
    output.s_m = s_m_[i] + along;
  }
  output.distance_m = std::sqrt(nearest2);
  const double beyond = output.distance_m - free_radius_m_;
  output.status = beyond > 0.0 && compliance_ < 1.0 ? FixtureStatus::kMoved : FixtureStatus::kFree;
  if (output.status == FixtureStatus::kMoved) {
    const double kept = (free_radius_m_ + compliance_ * beyond) / output.distance_m;
    output.p_RE_desired = output.p_path + kept * (p - output.p_path);
  }
  return output;
}

}  // namespace flextip
