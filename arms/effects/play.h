// Play as a state that is replayed: what follows stays while its leader turns back.
#pragma once

#include <Eigen/Dense>

namespace flextip::arms {

/// How plays are replayed. Searched for, not fitted.
struct PlayHistory {
  Eigen::VectorXd windows;  ///< whole widths, one a joint; empty: none were set
  /// Joints x joints: by how much the leader of joint i moves while joint j crosses its window.
  /// Empty: what is dragged does not pass through the play of what it drags.
  Eigen::MatrixXd carried;
  /// Windows of joints that `carried` ties, and its entries that are not zero, are the parameters.
  bool by_parameters = false;
};

/// Where in its play a follower stands behind `x`, in widths: -1/2 after a motion up, 1/2 after one
/// down, between them while the play is crossed. Rows are a history; it begins at `start`.
/// A width of zero is crossed at once.
Eigen::VectorXd PlayState(const Eigen::VectorXd& x, double width, double start = 0.0);

/// The same of all joints at once (rows x joints), where joints drag each other through their
/// plays: joint i stays while it can, and x_i + sum over j of carried_ij state_j leads it. That is
/// friction in each joint and cables that give way (a sweeping process, found row by row by
/// projected Gauss-Seidel). `start`: states at the first row.
Eigen::MatrixXd CarriedStates(const Eigen::MatrixXd& x, const Eigen::VectorXd& widths,
                              const Eigen::MatrixXd& carried, const Eigen::VectorXd& start);

/// Whether joint j drags others through their plays, or is dragged.
bool IsTied(const Eigen::MatrixXd& carried, Eigen::Index j);

/// Returns how far springs draw tied joints back (rows) per unit of each joint (columns).
/// `pull_back`: by how many widths of its play a spring draws a joint back, per unit of the joint.
Eigen::MatrixXd DrawnBack(const PlayHistory& history, const Eigen::VectorXd& pull_back);

}  // namespace flextip::arms
