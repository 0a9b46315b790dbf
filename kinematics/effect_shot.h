// One shot of the rod with effects: from guessed unknowns at wrist and port through to the tip,
// with what is left of the conditions and the derivatives. Private to kinematics.
#pragma once

#include <Eigen/Dense>

#include "kinematics/effect_columns.h"
#include "kinematics/effect_rod.h"

namespace flextip::effect_flow {

using InputVector = Eigen::Matrix<double, rod_input::kCount, 1>;

/// Returns the inputs in SI units, in the order of rod_input; the stiffness by its logarithm.
InputVector Inputs(const EffectRodProblem& problem);

/// The problem in units of L, EI/L^2 and EI/L: `g` in the order of rod_input, where the port's
/// entry is the span port - wrist, and the entries of wrist, stiffness and length are empty.
struct ScaledProblem {
  InputVector g = InputVector::Zero();
  Eigen::Vector3d y_wrist = Eigen::Vector3d::UnitY();
  double taper = 0.0;

  /// Returns the load along the stretch that starts `s` from the wrist.
  FlowLoad LoadFrom(double s, const Eigen::Vector3d& n0, const Eigen::Vector3d& q) const {
    return {n0, q, curvature(), 1.0 + taper * (s - 0.5), taper};
  }
  Eigen::Vector3d span() const { return g.segment<3>(rod_input::kPort); }
  Eigen::Vector3d f() const { return g.segment<3>(rod_input::kForce); }
  Eigen::Vector3d q() const { return g.segment<3>(rod_input::kWeight); }
  Eigen::Vector3d inside() const { return g.segment<3>(rod_input::kInside); }
  Eigen::Vector3d couple() const { return g.segment<3>(rod_input::kPortCouple); }
  Eigen::Vector2d curvature() const { return g.segment<2>(rod_input::kCurvature); }
  double PortCompliance() const { return g[rod_input::kPortCompliance]; }
  double WristCompliance() const { return g[rod_input::kWristCompliance]; }
  double friction() const { return g[rod_input::kPortFriction]; }
  /// Returns the problem with load and effects by a part only; wrist and port stay.
  ScaledProblem WithPart(double part) const;
};

/// From SI to scaled and back: scaled = SI x EI^a x L^b for each input.
struct EffectScaling {
  double L = 1.0, EI = 1.0;
  InputVector factor, by_stiffness, by_length;
  ScaledProblem scaled;

  explicit EffectScaling(const EffectRodProblem& problem);

  /// Turns derivatives by the scaled inputs into derivatives by the inputs in SI.
  template <int R>
  Eigen::Matrix<double, R, rod_input::kCount> ToInputs(
      const Eigen::Matrix<double, R, rod_input::kCount>& by_scaled) const {
    Eigen::Matrix<double, R, rod_input::kCount> out = by_scaled * factor.asDiagonal();
    out.template middleCols<3>(rod_input::kWrist) = -out.template middleCols<3>(rod_input::kPort);
    out.col(rod_input::kStiffness) = by_scaled * by_stiffness;
    out.col(rod_input::kLength) = by_scaled * by_length;
    return out;
  }
};

/// The unknowns: turns of the wrist tangent about the section's z axis and against its y axis, the
/// torsion moment at the wrist, the port's place, the port's force on the shaft.
inline constexpr int kTurn = 0, kTorsion = 2, kPlace = 3, kReaction = 4, kUnknowns = 7;
using UnknownVector = Eigen::Matrix<double, kUnknowns, 1>;
using ByUnknowns = Eigen::Matrix<double, 3, kUnknowns>;

/// Derivatives of the states at one place, by the unknowns and by the scaled inputs.
struct PlaceDerivative {
  ByUnknowns turn_x, m_x, P_x;
  InputDerivative turn_g, m_g, P_g;
};

inline constexpr double kMinLateral = 1e-6;  // scaled force below which friction fades out

struct EffectShot {
  FlowPath before, beyond;                            // wrist to port, port to tip
  FlowState wrist, port;                              // `port`: on the wrist's side of it
  Eigen::Vector3d n_wrist = Eigen::Vector3d::Zero();  // internal force at the wrist
  Eigen::Matrix<double, kUnknowns, 1> residual;
  Eigen::Matrix<double, kUnknowns, kUnknowns> A;          // of the residual by the unknowns
  Eigen::Matrix<double, kUnknowns, rod_input::kCount> B;  // and by the scaled inputs
  FlowColumns wrist_columns, port_columns, tip_columns;
  PlaceDerivative at_port;    // the port held at its place on the shaft
  ByUnknowns port_turn_x;     // the turn there as the port's place moves too
  PlaceDerivative at_beyond;  // the turn and moment just beyond the port, as it moves

  /// Walks the shaft and fills the residual. Returns false where the shaft cannot be walked.
  bool Shoot(const ScaledProblem& problem, const EffectRodUnknowns& x);
  /// Fills A after a walk. Returns false where it is not finite.
  bool Linearize(const ScaledProblem& problem, const EffectRodUnknowns& x);
  /// Fills A and B, and the other columns, which a converged shot needs. `places` (of the length,
  /// from the wrist) take the columns of the stretch they lie in.
  void Differentiate(const ScaledProblem& problem, const EffectRodUnknowns& x,
                     std::span<const double> places, FlowColumns* at_places);
  /// Turns the columns of the stretch before the port into derivatives; P from the unyielded wrist.
  PlaceDerivative Before(const ScaledProblem& problem, const EffectRodUnknowns& x,
                         const FlowColumns& columns, bool with_inputs) const;

 private:
  void StartColumns(const ScaledProblem& problem, const EffectRodUnknowns& x);
  void PassPort(const ScaledProblem& problem, const EffectRodUnknowns& x, bool with_inputs);
  void Conditions(const ScaledProblem& problem, const EffectRodUnknowns& x);
  void ConditionsByUnknowns(const ScaledProblem& problem, const EffectRodUnknowns& x);

  FlowForcing before_forcing_, beyond_forcing_;
};

// The columns of a stretch: what it starts from (before the port: the two turns and the torsion;
// beyond it: the turn and the moment at its start), then force, q and curvature.
inline constexpr int kBeforeForce = 3, kBeforeWeight = 6, kBeforeCurvature = 9, kBeforeEnd = 11;
inline constexpr int kBeyondForce = 6, kBeyondWeight = 9, kBeyondCurvature = 12, kBeyondEnd = 14;
inline constexpr int kNewtonColumns = 6;  // on either side the first six do for the unknowns

}  // namespace flextip::effect_flow
