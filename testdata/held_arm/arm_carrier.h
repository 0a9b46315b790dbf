// An arm by forces in time that carries a hidden recording's wrist along its course.
#pragma once

#include <vector>

#include "simulation/joints/arm_recording.h"
#include "testdata/hidden/carrier.h"

namespace flextip::hidden {

class ArmCarrier : public Carrier {
 public:
  /// The arm is put where the course is in the middle of its reach, and commanded along it by its
  /// file. `faults` is what its file does not say. `keep_wrist`: wrist0 stays, its positions by the
  /// arm's file, its orientations
  /// those of a passive wrist, measured against the last link.
  ArmCarrier(const Arm& arm, const simulation::ArmFaults& faults, bool keep_wrist,
             std::uint64_t seed);

  /// Throws WorkError where the course is beyond the arm's reach.
  void Follow(const Course& course, double from_s, double to_s) override;
  Eigen::Vector3d WristAt(double t_s) const override;
  void Record(Recording& recording, TimeNs start_ns) override;

 private:
  Eigen::Vector3d WristOf(const Arm& arm, const Eigen::VectorXd& q) const;
  Eigen::VectorXd JointsFor(const Eigen::Vector3d& p_RW, Eigen::VectorXd q) const;
  Eigen::VectorXd LinksAt(double t_s) const;
  Eigen::VectorXd EncodersAt(double t_s) const;
  std::size_t RowAt(double t_s, double& fraction) const;

  Arm arm_;
  simulation::ArmFaults faults_;
  bool keep_wrist_;
  std::uint64_t seed_;
  Arm true_arm_;
  double from_s_ = 0.0;
  Eigen::MatrixXd commands_;
  std::vector<simulation::ArmPlantState> states_;
};

}  // namespace flextip::hidden
