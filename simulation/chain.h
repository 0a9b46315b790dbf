// The shaft as a chain of straight links with elastic joints, and one Newton step toward the
// minimum of its energy. Everything here is in units of the shaft's length L and of EI / L^2, with
// the wrist at the origin.
//
// n1 equal links lie between wrist and port, n2 between port and tip, so that the port is always
// at a joint and the length s of the first part is a smooth unknown. With h_j the length of link j
// and c_i = 2 / (h_i + h_{i+1}) the stiffness of joint i, the Lagrangian is
//   E = sum_i c_i (1 - u_i . u_{i+1}) - f . x_tip - sum_j h_j q . x_mid_j - r . (x_port - p_port),
// where r, the multiplier of the port's constraint, is the port's force on the shaft. Stationary
// in the directions u_j (each on the unit sphere) and in s; f follows the load at the tip.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

namespace flextip {

/// The load on the tip and its derivative with respect to the tip's position.
struct ChainForce {
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
};

struct ChainProblem {
  int n1 = 0, n2 = 0;  ///< at least 4 each
  Eigen::Vector3d p_port = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();  ///< weight per length
  std::function<ChainForce(const Eigen::Vector3d&)> load;

  int Links() const { return n1 + n2; }
};

struct ChainState {
  std::vector<Eigen::Vector3d> u;               ///< unit directions from wrist to tip
  double s = 0.5;                               ///< of the port, from the wrist
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< force of the port
  Eigen::Vector3d f = Eigen::Vector3d::Zero();  ///< force on the tip
};

/// Lengths and joint stiffnesses for a given s, with their derivatives with respect to s.
class ChainGeometry {
 public:
  ChainGeometry(const ChainProblem& problem, double s);

  double h(int link) const { return link < n1_ ? h1_ : h2_; }
  double dh(int link) const { return link < n1_ ? dh1_ : dh2_; }
  /// Length of shaft beyond the middle of `link`, whose weight that section carries.
  double beyond(int link) const;
  double dbeyond(int link) const;
  /// Of the joint between `link` and the next one.
  double c(int link) const { return 1.0 / joint(link); }
  double dc(int link) const { return -djoint(link) / (joint(link) * joint(link)); }
  double ddc(int link) const;

 private:
  double joint(int link) const { return 0.5 * (h(link) + h(link + 1)); }
  double djoint(int link) const { return 0.5 * (dh(link) + dh(link + 1)); }

  int n1_, n2_;
  double h1_, h2_, dh1_, dh2_;
};

/// Positions of the chain's nodes, wrist (the origin) to tip: n1 + n2 + 1 of them.
std::vector<Eigen::Vector3d> ChainNodes(const ChainProblem& problem, const ChainState& state);

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
  static constexpr int kBorder = 9;  // direction of the link before the port, s, r, f
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

  void Assemble(const ChainState& state);
  void AssembleLink(int j, const ChainState& state, const ChainGeometry& geometry);
  void AssembleBorder(const ChainState& state, const ChainGeometry& geometry);
  bool ComputeStep();
  bool Eliminate(int j, int next);
  ChainState Moved(const ChainState& state, double fraction) const;
  double StepSize() const;

  const ChainProblem& problem_;
  std::vector<Link> links_;
  Border matrix_;        // of the border, as if f were a multiplier too (symmetric)
  BorderVector vector_;  // residuals of the border
  BorderVector border_step_;
  Eigen::Matrix3d stiffness_;
  double residual_ = 0.0;
};

}  // namespace flextip
