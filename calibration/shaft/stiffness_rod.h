// The rod of kinematics/rod.h with its taper, and derivatives by that too, for its calibration.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "kinematics/rod.h"

namespace flextip {

struct TaperedRodProblem {
  RodProblem rod;
  Eigen::Vector3d y_wrist = Eigen::Vector3d::UnitY();  ///< the instrument's y axis, not along it
};

/// Columns of the derivatives; the stiffness by its logarithm.
namespace tapered_input {
inline constexpr int kWrist = 0, kPort = 3, kForce = 6, kStiffness = 9, kTaper = 10, kCount = 11;
}  // namespace tapered_input
using TaperedDerivative = Eigen::Matrix<double, 3, tapered_input::kCount>;

/// All in R: place, tangent, the y axis carried along without twist, the moment of the part beyond
/// on the part before.
struct TaperedRodSection {
  Eigen::Vector3d p, t, y, m;
  TaperedDerivative dp, dt, dy, dm;
};

struct TaperedRodState {
  bool usable = false;
  double s_port_m = 0.0;
  TaperedRodSection wrist, tip;
  std::vector<TaperedRodSection> stations;  ///< as asked for, in that order
};

/// By shooting, integrated with Runge and Kutta's fourth order (sixteen steps and more: 1e-7 of
/// the length), derivatives by automatic differentiation. Starts from the last equilibrium.
class TaperedRodSolver {
 public:
  /// `stations_m` from the wrist, within the shaft.
  TaperedRodState Solve(const TaperedRodProblem& problem, std::span<const double> stations_m = {});

  struct Unknowns {  // in units of L and EI / L^2
    Eigen::Vector3d t_wrist = Eigen::Vector3d::UnitX();
    double s_port = 0.5;
    Eigen::Vector3d r = Eigen::Vector3d::Zero();  // of the port on the shaft
  };

 private:
  bool warm_ = false;
  Unknowns x_;
};

}  // namespace flextip
