#include "arms/model/kinematics.h"

#include "core/check.h"
#include "core/rotation.h"

namespace flextip::arms {
namespace {

Pose MotionOf(const ArmJoint& joint, double q) {
  const double by = q + joint.zero;
  if (joint.type == JointType::kRevolute)
    return {ExpRotation(by * joint.axis), Eigen::Vector3d::Zero()};
  return {Eigen::Matrix3d::Identity(), by * joint.axis};
}

}  // namespace

Kinematics::Kinematics(const Arm& arm, const Eigen::VectorXd& change) : arm_(arm) {
  FLEXTIP_CHECK(change.size() == 3 * arm.Size(), "three numbers a link");
  for (int i = 0; i < arm.Size(); ++i) {
    ArmJoint& joint = arm_.joints[i];
    if (change.segment<3>(3 * i).isZero(0.0)) continue;
    joint.a_m += change[3 * i];
    joint.d_m += change[3 * i + 1];
    joint.alpha_rad += change[3 * i + 2];
    PlaceJoint(arm_.convention, joint);
  }
}

std::vector<LinkPlace> Kinematics::Places(const Eigen::VectorXd& q) const {
  std::vector<LinkPlace> places;
  places.reserve(arm_.joints.size());
  Pose T = arm_.T_RB;
  for (int i = 0; i < arm_.Size(); ++i) {
    const ArmJoint& joint = arm_.joints[i];
    LinkPlace place;
    const Pose at_joint = T * joint.before;
    const Pose moved = at_joint * MotionOf(joint, q[i]);
    place.axis = at_joint.R * joint.axis;
    place.origin = at_joint.p;
    place.T = moved * joint.after;
    const bool modified = arm_.convention == ArmConvention::kModifiedDh;
    place.normal = modified ? T.R.col(0) : place.T.R.col(0);
    place.normal_origin = modified ? T.p : place.T.p;
    place.offset_axis = place.axis;
    T = place.T;
    places.push_back(place);
  }
  return places;
}

Eigen::MatrixXd Kinematics::Jacobian(const std::vector<LinkPlace>& places, int link,
                                     const Eigen::Vector3d& p_R) const {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, Size());
  for (int i = 0; i <= link; ++i) {
    const LinkPlace& place = places[i];
    if (arm_.joints[i].type == JointType::kRevolute) {
      J.col(i).head<3>() = place.axis.cross(p_R - place.origin);
      J.col(i).tail<3>() = place.axis;
    } else {
      J.col(i).head<3>() = place.axis;
    }
  }
  return J;
}

Eigen::MatrixXd Kinematics::GeometryJacobian(const std::vector<LinkPlace>& places, int link,
                                             const Eigen::Vector3d& p_R) const {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 3 * Size());
  for (int i = 0; i <= link; ++i) {
    const LinkPlace& place = places[i];
    J.col(3 * i).head<3>() = place.normal;
    J.col(3 * i + 1).head<3>() = place.offset_axis;
    J.col(3 * i + 2).head<3>() = place.normal.cross(p_R - place.normal_origin);
    J.col(3 * i + 2).tail<3>() = place.normal;
  }
  return J;
}

Eigen::Vector3d Kinematics::PayloadPoint(const PayloadPlace& place,
                                         const Eigen::VectorXd& q) const {
  const auto places = Places(q);
  if (place.keeps_orientation_of == 0) return places[place.link - 1].T * place.p_m;
  const int kept = place.keeps_orientation_of - 1;
  const Eigen::Vector3d hung =
      places[kept + 1].T * Eigen::Vector3d(place.bar_m.x(), place.bar_m.y(), 0.0);
  return hung + place.along_m * places[kept].T.R.col(0);
}

}  // namespace flextip::arms
