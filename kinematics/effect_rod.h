// Model 4: the rod of rod.h with all that may act on a real shaft besides (docs/method/models.md):
// an unloaded curvature, a port and an arm that yield, a port that resists rotation and sliding, a
// load spread over the part beyond the port, a stiffness that tapers. With derivatives of all
// outputs by every input but the taper.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <span>

#include "core/state_text.h"
#include "kinematics/rod.h"

namespace flextip {

/// Effects on the shaft besides wrist, port, tip force and weight, in R and SI units. All zero: the
/// plain rod.
struct RodEffects {
  /// The instrument's y axis at the wrist; its part across the shaft counts. From there the
  /// section's axes go along the shaft without twist, except that the torsion moment twists them
  /// (GJ = EI). A shaft that is straight when unloaded has no torsion moment.
  Eigen::Vector3d y_wrist = Eigen::Vector3d::UnitY();
  Eigen::Vector2d curvature_1_m = Eigen::Vector2d::Zero();  ///< unloaded, about the y and z axes
  double port_compliance_m_N = 0.0;   ///< the port moves by this times the lateral force on it
  double wrist_compliance_m_N = 0.0;  ///< the wrist moves by this times the force on the arm
  /// Rotational stiffness of the port times its rest axis: the couple on the shaft at the port is
  /// t_port x port_couple_Nm.
  Eigen::Vector3d port_couple_Nm = Eigen::Vector3d::Zero();
  /// The port's force on the shaft along t_port (towards the tip) over the size of its lateral
  /// force.
  double port_friction = 0.0;
  Eigen::Vector3d q_inside_N_m = Eigen::Vector3d::Zero();  ///< on the part beyond the port
};

void VisitState(RodEffects& effects, StateText& state);

struct EffectRodProblem {
  RodProblem rod;
  RodEffects effects;
};

/// First column of each input in an InputDerivative.
namespace rod_input {
inline constexpr int kWrist = 0, kPort = 3, kForce = 6;
inline constexpr int kStiffness = 9;  ///< by the logarithm of the bending stiffness
inline constexpr int kLength = 10;
inline constexpr int kWeight = 11;     ///< q_weight
inline constexpr int kCurvature = 14;  ///< two columns
inline constexpr int kPortCompliance = 16, kWristCompliance = 17;
inline constexpr int kPortCouple = 18;
inline constexpr int kPortFriction = 21;
inline constexpr int kInside = 22;  ///< q_inside
inline constexpr int kCount = 25;
}  // namespace rod_input

using InputDerivative = Eigen::Matrix<double, 3, rod_input::kCount>;
using InputGradient = Eigen::Matrix<double, 1, rod_input::kCount>;

/// A place on the shaft: `s_m` from the wrist, or from the tip (then it moves as the length does).
struct RodStation {
  double s_m = 0.0;
  bool from_tip = false;
};

/// The shaft at one place, all in R: position (m), unit tangent, the instrument's y axis carried
/// along the shaft (z = t x y), and the internal moment of the part beyond on the part before (Nm).
/// At the port itself the moment is that on the wrist's side.
struct EffectRodSection {
  double s_m = 0.0;  ///< from the wrist
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  InputDerivative dp = InputDerivative::Zero();
  InputDerivative dt = InputDerivative::Zero();
  InputDerivative dy = InputDerivative::Zero();
  InputDerivative dm = InputDerivative::Zero();
};

inline constexpr int kMaxRodStations = 4;

struct EffectRodState {
  RodStatus status = RodStatus::kNotConverged;
  int iterations = 0;
  EffectRodSection wrist, tip;  ///< the wrist where it truly is (it may have yielded)
  std::array<EffectRodSection, kMaxRodStations> stations;  ///< as asked for, in that order
  double s_port_m = 0.0;
  InputGradient ds_port = InputGradient::Zero();
  Eigen::Vector3d t_port = Eigen::Vector3d::UnitX();
  InputDerivative dt_port = InputDerivative::Zero();
  Eigen::Vector3d f_port =
      Eigen::Vector3d::Zero();  ///< of the port on the shaft, friction included
  InputDerivative df_port = InputDerivative::Zero();
  Eigen::Vector3d f_wrist = Eigen::Vector3d::Zero();  ///< of the wrist on the shaft

  bool IsUsable() const { return status == RodStatus::kOk; }
};

/// The solver's unknowns, in units of length L, force EI / L^2 and moment EI / L.
struct EffectRodUnknowns {
  Eigen::Vector3d t_wrist = Eigen::Vector3d::UnitX();
  double torsion = 0.0;                         ///< moment at the wrist along the tangent
  double s_port = 0.5;                          ///< from the wrist
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< port on the shaft
};

/// Solves problems one after the other, each started from the last. Allocates nothing; takes some
/// 120 kB of stack.
class EffectRodSolver {
 public:
  /// Returns the equilibrium with its derivatives, and the sections at up to kMaxRodStations
  /// stations strictly between wrist and tip. The status is kBadInput for a station outside, for
  /// more stations, and for a y_wrist along the line from wrist to port.
  EffectRodState Solve(const EffectRodProblem& problem, std::span<const RodStation> stations = {});

  void Reset() { warm_ = false; }

  /// Visits what the next solve starts from.
  void VisitState(StateText& state);

 private:
  // The last equilibrium and how it follows its inputs: a warm start for the next.
  bool warm_ = false;
  EffectRodUnknowns x_;
  Eigen::Vector3d y_ = Eigen::Vector3d::UnitY(), z_ = Eigen::Vector3d::UnitZ();  // at the wrist
  Eigen::Matrix<double, rod_input::kCount, 1> inputs_;
  Eigen::Matrix<double, 7, rod_input::kCount> dx_;
};

}  // namespace flextip
