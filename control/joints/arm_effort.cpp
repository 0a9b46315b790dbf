#include "control/joints/arm_effort.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace flextip {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStill_rad_s = 0.01, kStill_m_s = 0.001;  // friction turns over about this speed

struct LinkMotion {
  Matrix3d R;               ///< to the frame of the link before
  Vector3d p, joint, axis;  ///< its origin there; joint's centre and axis in the link's own frame
  Vector3d force, moment;   ///< what the link asks for, at its origin
};

bool IsFinite(const EffortJoint& j) {
  const Eigen::Matrix<double, 7, 1> numbers{j.zero,        j.mass_kg, j.motor_inertia, j.spring,
                                            j.effort_zero, j.coulomb, j.viscous};
  return numbers.allFinite() && j.R_before.allFinite() && j.R_after.allFinite() &&
         j.p_before.allFinite() && j.p_after.allFinite() && j.axis.allFinite() &&
         j.moment_kg_m.allFinite() && j.inertia_kg_m2.allFinite();
}

}  // namespace

ArmEffort::ArmEffort(std::span<const EffortJoint> joints, const Vector3d& gravity)
    : size_(int(joints.size())), gravity_(gravity) {
  if (joints.empty() || joints.size() > kMaxJoints) {
    throw InputError(
        fmt::format("an arm's efforts: found {} joints, expected 1 to {}", size_, kMaxJoints));
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!IsFinite(joints[i]) || !gravity.allFinite())
      throw InputError(
          fmt::format("an arm's efforts: joint {} has numbers that are not finite", i + 1));
    joints_[i] = joints[i];
  }
}

JointVector ArmEffort::Of(const JointVector& q, const JointVector& v,
                          const JointVector& a) const noexcept {
  std::array<LinkMotion, kMaxJoints> links;
  Vector3d turning = Vector3d::Zero(), turning_more = Vector3d::Zero(), pulled = -gravity_;
  for (int i = 0; i < size_; ++i) {
    const EffortJoint& j = joints_[i];
    LinkMotion& link = links[i];
    const double at = q[i] + j.zero;
    const Matrix3d turned =
        j.turns ? Eigen::AngleAxisd(at, j.axis).toRotationMatrix() : Matrix3d(Matrix3d::Identity());
    const Vector3d slid = j.turns ? Vector3d(Vector3d::Zero()) : Vector3d(at * j.axis);
    link.R = j.R_before * turned * j.R_after;
    link.joint = -(j.R_after.transpose() * j.p_after);
    link.axis = j.R_after.transpose() * j.axis;
    // The joint's centre moves with the link before it, and slides along it.
    const Vector3d centre = j.p_before + j.R_before * slid, along = j.R_before * j.axis;
    link.p = centre + j.R_before * turned * j.p_after;
    Vector3d centre_pulled =
        pulled + turning_more.cross(centre) + turning.cross(turning.cross(centre));
    if (!j.turns) centre_pulled += 2.0 * v[i] * turning.cross(along) + a[i] * along;
    const Vector3d carried = link.R.transpose() * turning;
    turning_more = link.R.transpose() * turning_more;
    turning = carried;
    if (j.turns) {
      turning += v[i] * link.axis;
      turning_more += a[i] * link.axis + v[i] * carried.cross(link.axis);
    }
    const Vector3d out = -link.joint;  // from the joint's centre to the frame's origin
    pulled = link.R.transpose() * centre_pulled + turning_more.cross(out) +
             turning.cross(turning.cross(out));
    link.force = j.mass_kg * pulled + turning_more.cross(j.moment_kg_m) +
                 turning.cross(turning.cross(j.moment_kg_m));
    link.moment = j.inertia_kg_m2 * turning_more + turning.cross(j.inertia_kg_m2 * turning) +
                  j.moment_kg_m.cross(pulled);
  }
  JointVector effort = JointVector::Zero(size_);
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();  // of all further links
  for (int i = size_; i-- > 0;) {
    const EffortJoint& j = joints_[i];
    const LinkMotion& link = links[i];
    force += link.force;
    moment += link.moment;
    const double still = j.turns ? kStill_rad_s : kStill_m_s;
    effort[i] = (j.turns ? link.axis.dot(moment - link.joint.cross(force)) : link.axis.dot(force)) +
                j.motor_inertia * a[i] + j.spring * q[i] + j.effort_zero +
                j.coulomb * std::tanh(v[i] / still) + j.viscous * v[i];
    force = link.R * force;
    moment = link.R * moment + link.p.cross(force);
  }
  return effort;
}

}  // namespace flextip
