// Play as a state that is replayed: what follows stays while its leader turns back.
#pragma once

#include <Eigen/Dense>

namespace flextip::arms {

/// Where in its play a follower stands behind `x`, in widths: -1/2 after a motion up, 1/2 after one
/// down, between them while the play is crossed. Rows are a history; it starts in the middle.
/// A width of zero is crossed at once.
Eigen::VectorXd PlayState(const Eigen::VectorXd& x, double width);

/// The same of all joints at once (rows x joints), where what one drags passes through the play of
/// the other: joint i follows x_i + sum over j of carried_ij state_j. Steps are parted, so that
/// joints that move together are dragged together.
Eigen::MatrixXd CarriedStates(const Eigen::MatrixXd& x, const Eigen::VectorXd& widths,
                              const Eigen::MatrixXd& carried);

}  // namespace flextip::arms
