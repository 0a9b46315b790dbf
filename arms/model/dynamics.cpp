#include "arms/model/dynamics.h"

#include "core/rotation.h"

namespace flextip::arms {
namespace {

using Eigen::Vector3d;

/// I w as a matrix on the six numbers of I.
Eigen::Matrix<double, 3, 6> InertiaTimes(const Vector3d& w) {
  Eigen::Matrix<double, 3, 6> L;
  L << w.x(), w.y(), w.z(), 0, 0, 0,  //
      0, w.x(), 0, w.y(), w.z(), 0,   //
      0, 0, w.x(), 0, w.y(), w.z();
  return L;
}

/// How a link's frame moves: all in R, the acceleration with gravity taken off.
struct Moving {
  Vector3d w = Vector3d::Zero(), dw = Vector3d::Zero(), a = Vector3d::Zero();
};

std::vector<Moving> MotionOfLinks(const Kinematics& arm, const std::vector<LinkPlace>& places,
                                  const Motion& motion, const Vector3d& gravity_m_s2) {
  std::vector<Moving> moving;
  Moving last;
  last.a = -gravity_m_s2;
  Vector3d p = arm.Described().T_RB.p;
  for (int i = 0; i < arm.Size(); ++i) {
    const LinkPlace& place = places[i];
    const Vector3d& z = place.axis;
    const auto carried = [](const Moving& m, const Vector3d& r) -> Vector3d {
      return m.dw.cross(r) + m.w.cross(m.w.cross(r));
    };
    Moving next = last;
    if (arm.Described().joints[i].type == JointType::kRevolute) {
      next.w += z * motion.v[i];
      next.dw += z * motion.a[i] + last.w.cross(z) * motion.v[i];
      next.a += carried(last, place.origin - p) + carried(next, place.T.p - place.origin);
    } else {
      next.a +=
          carried(last, place.T.p - p) + 2.0 * last.w.cross(z) * motion.v[i] + z * motion.a[i];
    }
    moving.push_back(next);
    last = next;
    p = place.T.p;
  }
  return moving;
}

}  // namespace

Eigen::MatrixXd EffortRegressor(const Kinematics& arm, const Motion& motion,
                                const Vector3d& gravity_m_s2) {
  const int n = arm.Size();
  const auto places = arm.Places(motion.q);
  const auto moving = MotionOfLinks(arm, places, motion, gravity_m_s2);
  Eigen::MatrixXd regressor = Eigen::MatrixXd::Zero(n, kLinkNumbers * n);
  for (int j = 0; j < n; ++j) {
    const Eigen::Matrix3d& R = places[j].T.R;
    const Vector3d w = R.transpose() * moving[j].w, dw = R.transpose() * moving[j].dw,
                   a = R.transpose() * moving[j].a;
    Eigen::Matrix<double, 3, kLinkNumbers> force, moment;
    force.setZero();
    moment.setZero();
    force.col(0) = a;
    force.middleCols<3>(1) = Skew(dw) + Skew(w) * Skew(w);
    moment.middleCols<3>(1) = -Skew(a);
    moment.rightCols<6>() = InertiaTimes(dw) + Skew(w) * InertiaTimes(w);
    force = R * force;
    moment = R * moment;
    for (int i = 0; i <= j; ++i) {
      auto row = regressor.block<1, kLinkNumbers>(i, kLinkNumbers * j);
      if (arm.Described().joints[i].type == JointType::kPrismatic) {
        row = places[i].axis.transpose() * force;
      } else {
        const Vector3d lever = places[j].T.p - places[i].origin;
        row = places[i].axis.transpose() * (moment + Skew(lever) * force);
      }
    }
  }
  return regressor;
}

Eigen::VectorXd PayloadEffort(const Kinematics& arm, const PayloadPlace& place,
                              const Motion& motion, const Vector3d& gravity_m_s2) {
  // Along the motion by differences in time, across it by the joints: both fourth order.
  const auto at = [&](double t) {
    return arm.PayloadPoint(place, motion.q + t * motion.v + 0.5 * t * t * motion.a);
  };
  constexpr double h = 2e-3, dq = 1e-5;
  const Vector3d acceleration =
      (-at(2 * h) + 16.0 * at(h) - 30.0 * at(0.0) + 16.0 * at(-h) - at(-2 * h)) / (12.0 * h * h);
  Eigen::VectorXd effort(arm.Size());
  for (int i = 0; i < arm.Size(); ++i) {
    const Eigen::VectorXd step = dq * Eigen::VectorXd::Unit(arm.Size(), i);
    const Vector3d along =
        (arm.PayloadPoint(place, motion.q + step) - arm.PayloadPoint(place, motion.q - step)) /
        (2.0 * dq);
    effort[i] = along.dot(acceleration - gravity_m_s2);
  }
  return effort;
}

Eigen::VectorXd NumbersOf(const ArmLink& link) {
  Eigen::VectorXd numbers(kLinkNumbers);
  const Vector3d& c = link.com_m;
  const Eigen::Matrix3d I =
      link.mass_kg * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  numbers << link.mass_kg, link.mass_kg * c, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2);
  return numbers;
}

}  // namespace flextip::arms
