// The prediction of one axis of a target at a point of the clock, with the axis's own noise.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calibration/clock/clock_rows.h"
#include "calibration/clock/residual_noise.h"

namespace flextip {

/// Features and derivatives over one size each, with a constant as last column.
struct ScaledRows {
  Eigen::MatrixXd x, velocity, by_play;
  Eigen::VectorXd since_s;
  std::vector<int> before;
};

/// What is learnt of an axis and kept from point to point.
struct AxisModel {
  Autoregression noise = {};
  double scale = 1.0;            ///< of the innovations
  Eigen::VectorXd kind_sd = {};  ///< of the coefficients of each kind of predictors
  bool linear = false;           ///< the small predictors stay out
  Eigen::VectorXd weight = {};   ///< of the innovations, Huber's
};

/// Parts of the normal equations of (offset, rate, play) once the prediction is eliminated.
struct ClockNormal {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  /// The same with the linear predictors alone; the others' part is in the residual then.
  Eigen::Matrix3d plain_normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d plain_right = Eigen::Vector3d::Zero();
  Eigen::MatrixXd scores = {};  ///< parts of `right`, a row a sample
  double speed_squares = 0.0;   ///< of the prediction's derivative by the offset, not whitened
  double likelihood = 0.0;      ///< twice the logarithm, up to a constant
  double parameters = 0.0;      ///< that were free, the small ones by their part
  double kept = 0.0;            ///< innovations
};

/// Solves for the prediction, adds to `sum`, and returns the residual. `learn` sets sizes, scale
/// and weights of the axis anew. `plain` fills plain_normal and plain_right.
Eigen::VectorXd AddAxis(const ScaledRows& rows, const Predictors& reference,
                        const Eigen::VectorXd& y, bool learn, bool plain, AxisModel& axis,
                        ClockNormal& sum);

}  // namespace flextip
