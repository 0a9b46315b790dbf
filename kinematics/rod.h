// The exact statics of an inextensible Kirchhoff rod with a circular section: pinned at the wrist,
// sliding through a frictionless port that pushes only sideways, loaded at the tip by a force and
// along its length by its weight (docs/method/models.md, model 3):
//   p' = t,  t' = kappa x t,  n' = -q,  m' = n x t,  kappa = m / EI.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "core/state_text.h"
#include "kinematics/rod/point.h"

namespace flextip {

/// One equilibrium problem, in R and SI units.
struct RodProblem {
  double length_m = 0.0;
  double bending_stiffness_Nm2 = 0.0;
  Eigen::Vector3d p_wrist = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_port = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_tip = Eigen::Vector3d::Zero();     ///< force on the tip (N)
  Eigen::Vector3d q_weight = Eigen::Vector3d::Zero();  ///< force per length on the shaft (N/m)
  /// Taper of the stiffness, EI (1 + taper (s / L - 1/2)), s from the wrist; above -2 and below 2.
  /// RodSolver takes 0 only.
  double stiffness_taper = 0.0;
};

void VisitState(RodProblem& problem, StateText& state);

enum class RodStatus : std::uint8_t {
  kOk,
  kBadInput,      ///< not finite, or length or stiffness not positive, or a taper
  kUnreachable,   ///< the port is at or beyond the shaft's length, or on the wrist
  kNotConverged,  ///< no equilibrium found near the straight shaft (buckled, load too high)
};
const char* Name(RodStatus status);

/// Derivatives of a vector by wrist position, port position and tip force (3x9).
using RodDerivative = Eigen::Matrix<double, 3, 9>;  // columns: d/dp_wrist, d/dp_port, d/df_tip

/// The rod at one place: position, unit tangent, internal moment of the part beyond on the part
/// before (Nm), and their derivatives.
struct RodSection {
  double s_m = 0.0;  ///< from the wrist along the shaft
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  RodDerivative dp = RodDerivative::Zero();
  RodDerivative dt = RodDerivative::Zero();
  RodDerivative dm = RodDerivative::Zero();
};

struct RodState {
  RodStatus status = RodStatus::kNotConverged;
  int iterations = 0;     ///< walks along the rod
  double residual = 0.0;  ///< of the scaled conditions
  RodSection wrist, tip;  ///< at s = 0 and s = length
  double s_port_m = 0.0;
  Eigen::Vector3d t_port = Eigen::Vector3d::UnitX();
  RodDerivative dt_port = RodDerivative::Zero();      ///< of t_port
  Eigen::Vector3d f_port = Eigen::Vector3d::Zero();   ///< of the port on the shaft (N)
  Eigen::Vector3d f_wrist = Eigen::Vector3d::Zero();  ///< of the wrist on the shaft (N)

  bool IsUsable() const { return status == RodStatus::kOk; }
  /// Returns d tip / d wrist (3x3) with the tip force held constant.
  Eigen::Matrix3d J_tip_wrist() const { return tip.dp.leftCols<3>(); }
  /// Returns d tip / d wrist (3x3) when the load follows the tip: `stiffness` = df_tip/dp_tip (3x3,
  /// N/m, negative definite for tissue that pushes back).
  Eigen::Matrix3d J_tip_wrist(const Eigen::Matrix3d& stiffness) const;
};

/// Solves rod problems one after the other and starts each from the last equilibrium it found.
/// Allocates nothing.
class RodSolver {
 public:
  /// Returns the equilibrium with its derivatives. Tries a warm start, then a cold one with the
  /// load applied in steps. `RodState::status` says how that ended.
  RodState Solve(const RodProblem& problem);

  /// Returns the last solved rod at `s_m` from the wrist (m, 0 <= s_m <= length). Needs IsUsable().
  RodSection Section(double s_m) const;

  /// Forgets the last equilibrium: the next solve starts from the straight shaft.
  void Reset() { warm_ = false; }

  /// Visits what the next solve starts from. Section() needs a solve first.
  void VisitState(StateText& state);

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Unknowns {  // in units of length L and force EI / L^2
    Eigen::Vector3d t_tip = Eigen::Vector3d::UnitX();
    Eigen::Vector3d y_tip = Eigen::Vector3d::UnitY();  // unit, across t_tip: the turns are by it
    double sigma_port = 0.5;                           // from the tip
    Eigen::Vector3d r = Eigen::Vector3d::Zero();       // port on the shaft

    void Move(const Vector6& dx);
  };
  /// What is known of the conditions before the first walk.
  struct Start {
    bool near = false;   // `inverse` holds nearly
    bool same = false;   // the problem is that of `inverse`
    double rate = 0.0;   // by which `inverse` takes the residual down; 0: by the first residual
    double moved = 0.0;  // size of the change of the unknowns since it was made
  };
  struct Scaled;
  struct Evaluation;

  static Unknowns StraightGuess(const Scaled& scaled);
  /// Walks the rod. The derivatives stay as they are unless they are asked for.
  static void Evaluate(const Scaled& scaled, const Unknowns& x, bool with_derivatives,
                       Evaluation& e);
  /// Returns the number of walks; 0 where the iteration did not converge.
  static int Newton(const Scaled& scaled, const Start& start, Unknowns& x, Evaluation& e);
  static int SolveCold(const Scaled& scaled, Unknowns& x, Evaluation& e);
  int SolveWarm(const RodProblem& problem, const Scaled& scaled, Unknowns& x, Evaluation& e);
  void Keep(const RodProblem& problem, const Unknowns& x, const Evaluation& e);
  void FillState(const Evaluation& e, RodState& state);
  /// Returns derivatives by the solver's columns as derivatives by wrist, port and force.
  template <int R>
  Eigen::Matrix<double, R, 9> Total(const Eigen::Matrix<double, R, 9>& by_columns) const;
  RodSection MakeSection(const RodPlace& place, double s_m) const;

  // The last equilibrium: a warm start for the next, and what Section() walks along.
  bool warm_ = false;
  RodProblem problem_;
  Unknowns x_;
  RodPlace port_;
  Matrix6 inverse_ = Matrix6::Zero();  // of the conditions' derivative by the unknowns
  Eigen::Matrix<double, 6, 9> dx_ = Eigen::Matrix<double, 6, 9>::Zero();  // by wrist, port, force
  Vector6 predicted_ = Vector6::Zero();  // the last prediction of the unknowns' change
  Vector6 missed_ = Vector6::Zero();     // and what it missed
  RodSection tip_;
};

}  // namespace flextip
