// The shaft as a chain of straight links with elastic joints, and Newton's method toward its
// equilibrium. Everything here is in units of the shaft's length L and of EI / L^2.
//
// n1 equal links lie between wrist and port, n2 between port and tip, so that the port is always
// at a joint and the length s of the first part is a smooth unknown. With h_j the length of link j
// and c_i = 2 / (h_i + h_{i+1}) the stiffness of joint i, the Lagrangian of the plain chain is
//   E = sum_i c_i (1 - u_i . u_{i+1}) - f . x_tip - sum_j h_j q . x_mid_j - r . (x_port - p_port),
// where r, the multiplier of the port's constraint, is the port's force on the shaft. Stationary
// in the directions u_j (each on the unit sphere) and in s; f follows the load at the tip.
//
// What else may act (chain_problem.h) enters the same conditions: unloaded curvature and the port's
// torsion spring as energies, compliances in the constraints and the tip's place, a second contact
// as an unknown force with its law. Friction is a force in the condition on s, which without it
// says r . t_port = 0. A few small derivatives are left out (of the frames' twist, of the port's
// tangent), so that with effects the last digits come linearly.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "simulation/plant/chain_curvature.h"
#include "simulation/plant/chain_geometry.h"
#include "simulation/plant/chain_port.h"
#include "simulation/plant/chain_problem.h"

namespace flextip::simulation {

/// Newton's method on the chain. Keeps its storage between steps.
class ChainNewton {
 public:
  explicit ChainNewton(const ChainProblem& problem);

  struct Result {
    bool converged = false;
    int iterations = 0;
    double residual = 0.0;  ///< norm of the conditions in their strong form
  };
  /// Improves `state`; on failure `state` is what the last step left.
  Result Solve(ChainState& state);

 private:
  static constexpr int kBorder = 10;  // direction of the link before the port, s, r, f, contact
  static constexpr int kS = 2, kR = 3, kF = 6, kC = 9;  // places in it
  using Border = Eigen::Matrix<double, kBorder, kBorder>;
  using BorderVector = Eigen::Matrix<double, kBorder, 1>;

  struct Link {  // row of one link: diagonal, coupling to the next eliminated link, border,
                 // residual
    Eigen::Matrix<double, 3, 2> basis;
    Eigen::Matrix2d diagonal, inverse, next;
    Eigen::Matrix<double, 2, kBorder> border;
    Eigen::Vector2d residual;
    Eigen::Vector2d step;
  };
  struct LinkLoad {                                     // of the forces at single places
    Eigen::Vector3d through = Eigen::Vector3d::Zero();  // those beyond the link
    Eigen::Vector3d own = Eigen::Vector3d::Zero();      // sum of d f of those on it, and of dd f
    Eigen::Vector3d down = Eigen::Vector3d::Zero();
  };

  void Assemble(const ChainState& state);
  void AssemblePoints(const ChainState& state, const ChainGeometry& geometry);
  void AssembleLink(int j, const ChainState& state, const ChainGeometry& geometry);
  void AssembleJoint(int j, const ChainState& state, const ChainGeometry& geometry);
  void AssembleCouplings(const ChainGeometry& geometry);
  void AssembleBorder(const ChainState& state, const ChainGeometry& geometry);
  void AssembleYield(const ChainState& state);
  void AssembleSliding(const ChainState& state, const Eigen::Vector3d& x_port);
  void AssembleContact(const ChainState& state, const ChainGeometry& geometry);
  bool ComputeStep();
  bool Eliminate(int j, int next);
  ChainState Moved(const ChainState& state, double fraction) const;
  double StepSize() const;

  const ChainProblem& problem_;
  const bool curved_, pointed_;
  std::vector<Link> links_;
  std::vector<LinkLoad> loads_;
  std::vector<Eigen::Vector3d> gradient_, mixed_;
  ChainRest rest_;
  PortHinge hinge_;
  Border matrix_;        // of the border, as if f were a multiplier too (symmetric)
  BorderVector vector_;  // residuals of the border
  BorderVector border_step_;
  Eigen::Matrix3d stiffness_;
  double contact_slope_ = 0.0;  // of the second contact's force by its depth
  double residual_ = 0.0;
};

}  // namespace flextip::simulation
