// The conditions of the rod's equilibrium, their derivatives by the unknowns, and the unknowns'
// limits in one step. Private to the rod's solver.
#pragma once

#include <cmath>

#include "kinematics/rod.h"
#include "kinematics/rod/flow.h"

namespace flextip {

inline constexpr int kMaxNewton = 20;
inline constexpr double kMaxTurn = 0.4;  // of the tip tangent in one Newton step (rad)
inline constexpr double kMinStretch =
    1e-6;  // shortest stretch on either side of the port, of the length

// Columns of the derivatives: the unknowns (two turns of the tip tangent, the port's place, the
// port's force), then the tip force.
inline constexpr int kTurn = 0, kPlace = 2, kReaction = 3, kForce = 6;

/// The problem in units of L, EI/L^2 and EI/L.
struct RodSolver::Scaled {
  Eigen::Vector3d span = Eigen::Vector3d::Zero();  // port - wrist
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();

  explicit Scaled(const RodProblem& problem)
      : span((problem.p_port - problem.p_wrist) / problem.length_m),
        f(problem.f_tip * (problem.length_m * problem.length_m / problem.bending_stiffness_Nm2)),
        q(problem.q_weight * (std::pow(problem.length_m, 3) / problem.bending_stiffness_Nm2)) {}
  Scaled WithLoad(double part) const {
    Scaled scaled = *this;
    scaled.f *= part;
    scaled.q *= part;
    return scaled;
  }
};

/// The whole rod for given unknowns: states at port and wrist, and the residual of the conditions
/// (port - wrist, no moment at the wrist, no force along the shaft at the port).
struct RodSolver::Evaluation {
  RodPlace port, wrist;
  Eigen::Vector3d n_beyond;  // internal force just beyond the port
  Vector6 residual;
  Vector6 corrected;  // change of the unknowns since the start
  Eigen::Matrix<double, 6, kRodColumns> derivative;
  Matrix6 inverse;  // of its columns for the unknowns
  bool ok = false;

  void Differentiate(const RodMap& tip_stretch, const RodMap& wrist_stretch, const Unknowns& x);
  void Learn(const Vector6& dx, const Vector6& change);
  void Correct(const Vector6& dx);
};

/// Fills the derivatives at a place between tip and port: by the turns and the force only.
void FillTipStretch(const RodMap& map, RodPlace& place);

/// Fills the derivatives at a place between port and wrist. Moving the port along the shaft moves
/// the jump of the internal force, which shows as an initial change of the moment.
void FillWristStretch(const RodMap& map, const RodPlace& port, const Eigen::Vector3d& r,
                      RodPlace& place);

}  // namespace flextip
