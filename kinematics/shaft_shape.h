// One shape of the shaft by any of the models, with what a table of equilibria says of it.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "kinematics/rod.h"

namespace flextip {

enum class ShapeModel { kRod, kBeam, kStraight };

/// In R. `status` is "ok", or says why there is no shape; then nothing else means anything.
struct Shape {
  std::string status = "not solved";
  bool bad_input = false;  ///< the problem itself is at fault, not the solver
  Eigen::Vector3d p_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d t_wrist = Eigen::Vector3d::UnitX(), t_tip = Eigen::Vector3d::UnitX();
  double s_port_m = 0.0;
  Eigen::Vector3d f_port = Eigen::Vector3d::Zero();   ///< of the port on the shaft (N)
  Eigen::Vector3d f_wrist = Eigen::Vector3d::Zero();  ///< of the wrist on the shaft (N)
  /// Internal moments (Nm) of the part beyond on the part before, half-way from the wrist to the
  /// port and half-way from the port to the tip.
  Eigen::Vector3d m_half_wrist = Eigen::Vector3d::Zero();
  Eigen::Vector3d m_half_tip = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> points;  ///< the centre line from wrist to tip

  bool IsUsable() const { return status == "ok"; }
};

/// Solves from a cold start. The beam knows no self-weight: with one it is refused ("bad input").
Shape SolveShape(const RodProblem& problem, ShapeModel model);

}  // namespace flextip
