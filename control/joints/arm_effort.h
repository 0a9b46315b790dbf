// The efforts that a motion of an arm asks of its motors: Newton and Euler's equations link by link
// (Featherstone 2008, chapter 5), with friction, springs and zeros. Fixed size.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <span>

namespace flextip {

inline constexpr int kMaxJoints = 32;
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;

/// A joint and the link after it: T = before * motion(q + zero) * after, about or along `axis`.
struct EffortJoint {
  bool turns = true;
  Eigen::Matrix3d R_before = Eigen::Matrix3d::Identity(), R_after = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_before = Eigen::Vector3d::Zero(), p_after = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double zero = 0.0;
  /// Of the link, in its frame and about its origin: kg, kg m, kg m^2.
  double mass_kg = 0.0;
  Eigen::Vector3d moment_kg_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
  /// Effort by the joint's acceleration, by its place, always; against its motion.
  double motor_inertia = 0.0, spring = 0.0, effort_zero = 0.0, coulomb = 0.0, viscous = 0.0;
};

class ArmEffort {
 public:
  /// `gravity` (m/s^2) in the base's frame. Takes kMaxJoints joints at most; throws InputError for
  /// more, and for numbers that are not finite.
  ArmEffort(std::span<const EffortJoint> joints, const Eigen::Vector3d& gravity);

  int Size() const { return size_; }
  /// Returns the efforts for joints with their rates (each of that size). Does not allocate.
  JointVector Of(const JointVector& q, const JointVector& v, const JointVector& a) const noexcept;

 private:
  int size_ = 0;
  std::array<EffortJoint, kMaxJoints> joints_;
  Eigen::Vector3d gravity_;
};

}  // namespace flextip
