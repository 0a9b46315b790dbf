// The samples that a target and a reference both have at a point of the clock.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calibration/clock/predictors.h"

namespace flextip {

/// Offset (s), rate and play (m).
using ClockPoint = Eigen::Vector3d;

/// A row a sample.
struct ClockRows {
  Eigen::MatrixXd x, velocity, by_play;  ///< features, their derivatives by time (s) and play (m)
  Eigen::MatrixXd y;                     ///< the target's values
  Eigen::VectorXd since_s;               ///< the origin
  std::vector<int> before;               ///< samples before it without a gap
  std::vector<double> t_s;

  Eigen::Index Count() const { return x.rows(); }
};

/// Gathers the rows at a point; `by_play` only where asked for.
ClockRows GatherRows(const Motion& target, Predictors& reference, const ClockPoint& point,
                     double origin_s, bool with_play);

}  // namespace flextip
