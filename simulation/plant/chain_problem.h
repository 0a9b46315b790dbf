// The parts of the chain of chain.h, its loads, and its state. Everything is in units of the
// shaft's length L and of EI / L^2. The origin is the wrist's place by the arm without force. The
// chain itself starts at the true wrist, which a yielding arm moves away from the origin.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <vector>

namespace flextip::simulation {

/// The load on the tip and its derivative with respect to the tip's position.
struct ChainForce {
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
};

/// The port's actions besides holding the shaft sideways.
struct ChainPort {
  double compliance = 0.0;  ///< the port moves by this times the lateral force on it
  double play = 0.0;        ///< radius of the hole
  double play_force =
      1.0;             ///< lateral force at which the shaft has moved 0.7 of the way to the rim
  double hinge = 0.0;  ///< torsion spring between the shaft's tangent and `rest_axis`
  Eigen::Vector3d rest_axis = Eigen::Vector3d::UnitX();
};

/// Friction along the shaft at the port; the force on the shaft is along the tangent there.
struct ChainFriction {
  enum class Mode { kNone, kStick, kSlip };
  Mode mode = Mode::kNone;
  double stiffness = 0.0;       ///< of the bristles, while sticking
  double anchor = 0.0;          ///< s where the bristles are relaxed
  double sign = 0.0;            ///< of the change of s, while slipping
  double coefficient = 0.0;     ///< bound over lateral force
  double grip = 0.0;            ///< bound without lateral force
  double from = 0.0, to = 0.0;  ///< s where there is friction; equal: everywhere
};

/// A force on the shaft at `place` from the wrist along the shaft.
struct ChainPoint {
  double place = 0.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
};

/// A half space that pushes the shaft's point at `place` along `normal`; quadratic onset.
struct ChainContact {
  double place = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
  double stiffness = 0.0, onset = 1.0;
};

struct ChainProblem {
  int n1 = 0, n2 = 0;  ///< links before and behind the port, at least 4 each
  Eigen::Vector3d p_port = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();         ///< force per length on the shaft
  Eigen::Vector3d q_inside = Eigen::Vector3d::Zero();  ///< on the part beyond the port
  std::function<ChainForce(const Eigen::Vector3d&)> load;
  double taper = 0.0;                                   ///< stiffness is 1 + taper (1 - 2 s)
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero();  ///< unloaded, about the carried y and z
  double roll_rad = 0.0;                                ///< of those axes at the wrist
  double torsion = 1.0;  ///< torsional over bending stiffness, where there is curvature
  double wrist_compliance = 0.0, tip_compliance = 0.0;
  ChainPort port;
  ChainFriction friction;
  std::vector<ChainPoint> points;
  std::optional<ChainContact> contact;

  int Links() const { return n1 + n2; }
  bool IsCurved() const { return curvature != Eigen::Vector2d::Zero(); }
};

struct ChainState {
  std::vector<Eigen::Vector3d> u;               ///< unit directions from wrist to tip
  double s = 0.5;                               ///< of the port, from the wrist
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< force of the port
  Eigen::Vector3d f = Eigen::Vector3d::Zero();  ///< force on the tip
  double contact = 0.0;                         ///< force of the second contact
};

/// Returns the force on the arm (N, in R): all that acts on the shaft but the wrist.
Eigen::Vector3d ForceOnArm(const ChainProblem& problem, const ChainState& state);

/// Returns the true wrist's place (m, in R).
inline Eigen::Vector3d TrueWrist(const ChainProblem& problem, const ChainState& state) {
  if (problem.wrist_compliance == 0.0) return Eigen::Vector3d::Zero();
  return problem.wrist_compliance * ForceOnArm(problem, state);
}

}  // namespace flextip::simulation
