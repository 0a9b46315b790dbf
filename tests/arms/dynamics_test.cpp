// Efforts against the energy of point masses: the power that the joints give is the energy's rate.
#include "arms/model/dynamics.h"

#include <gtest/gtest.h>

#include "core/rotation.h"
#include "tests/arms/made_arm.h"

namespace flextip::arms {
namespace {

const Eigen::Vector3d kGravity(0.5, -1.0, -9.5);

struct Body {
  int link;
  double mass_kg;
  Eigen::Vector3d p_m;
};

Motion MotionAt(double t) {
  Motion motion{Eigen::VectorXd(3), Eigen::VectorXd(3), Eigen::VectorXd(3)};
  const double w[] = {2.1, 1.3, 1.7}, size[] = {0.8, 0.6, 0.1};
  for (int i = 0; i < 3; ++i) {
    motion.q[i] = 0.2 + size[i] * std::sin(w[i] * t + i);
    motion.v[i] = size[i] * w[i] * std::cos(w[i] * t + i);
    motion.a[i] = -size[i] * w[i] * w[i] * std::sin(w[i] * t + i);
  }
  return motion;
}

Eigen::Vector3d PointAt(const Kinematics& arm, const Body& body, double t) {
  return arm.Places(MotionAt(t).q)[body.link].T * body.p_m;
}

double EnergyAt(const Kinematics& arm, const std::vector<Body>& bodies, double t) {
  constexpr double h = 1e-4;
  double energy = 0.0;
  for (const Body& body : bodies) {
    const Eigen::Vector3d v = (PointAt(arm, body, t + h) - PointAt(arm, body, t - h)) / (2 * h);
    energy += body.mass_kg * (0.5 * v.squaredNorm() - kGravity.dot(PointAt(arm, body, t)));
  }
  return energy;
}

TEST(ArmDynamics, PowerIsTheRateOfTheEnergy) {
  const Kinematics arm(ThreeJointsWithMasses());
  // Several points a link: their inertia is no single point's.
  const std::vector<Body> bodies{{0, 1.0, {0.1, 0.0, 0.2}},  {0, 0.5, {0.0, 0.2, 0.1}},
                                 {1, 0.7, {0.2, -0.1, 0.0}}, {1, 0.4, {0.0, 0.1, 0.3}},
                                 {2, 0.6, {0.1, 0.1, 0.1}},  {2, 0.3, {-0.2, 0.0, 0.1}}};
  Eigen::VectorXd numbers = Eigen::VectorXd::Zero(3 * kLinkNumbers);
  for (const Body& body : bodies)
    numbers.segment(kLinkNumbers * body.link, kLinkNumbers) += NumbersOf({body.mass_kg, body.p_m});
  for (const double t : {0.1, 0.7, 1.9}) {
    const Motion motion = MotionAt(t);
    const Eigen::VectorXd effort = EffortRegressor(arm, motion, kGravity) * numbers;
    constexpr double h = 1e-3;
    const double rate = (EnergyAt(arm, bodies, t + h) - EnergyAt(arm, bodies, t - h)) / (2 * h);
    EXPECT_NEAR(effort.dot(motion.v), rate, 1e-4 * (1.0 + std::abs(rate))) << t;
  }
}

TEST(ArmDynamics, GravityAtRestIsTheSlopeOfItsEnergy) {
  const Kinematics arm(ThreeJointsWithMasses());
  const Body body{2, 0.9, {0.2, 0.1, -0.1}};
  Eigen::VectorXd numbers = Eigen::VectorXd::Zero(3 * kLinkNumbers);
  numbers.tail(kLinkNumbers) = NumbersOf({body.mass_kg, body.p_m});
  Motion motion = MotionAt(0.4);
  motion.v.setZero();
  motion.a.setZero();
  const Eigen::VectorXd effort = EffortRegressor(arm, motion, kGravity) * numbers;
  for (int i = 0; i < 3; ++i) {
    const auto energy = [&](double by) {
      Eigen::VectorXd q = motion.q;
      q[i] += by;
      return -body.mass_kg * kGravity.dot(arm.Places(q)[2].T * body.p_m);
    };
    EXPECT_NEAR(effort[i], (energy(1e-5) - energy(-1e-5)) / 2e-5, 1e-6);
  }
}

TEST(ArmDynamics, PayloadIsAPointOfItsLink) {
  const Arm described = ThreeJointsWithMasses();
  const Kinematics arm(described);
  const PayloadPlace place{"somewhere", 2, {0.1, -0.05, 0.2}};
  const Motion motion = MotionAt(1.1);
  const Eigen::MatrixXd regressor = EffortRegressor(arm, motion, kGravity);
  const Eigen::VectorXd as_link =
      regressor.middleCols(kLinkNumbers, kLinkNumbers) * NumbersOf({1.0, place.p_m});
  EXPECT_LT((PayloadEffort(arm, place, motion, kGravity) - as_link).norm(), 1e-5);
}

}  // namespace
}  // namespace flextip::arms
