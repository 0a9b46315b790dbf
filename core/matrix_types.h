// Names for the fixed sizes that poses need and Eigen has no names for.
#pragma once

#include <Eigen/Core>

namespace flextip {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

}  // namespace flextip
