// Where the tip is expected before a frame has been looked at.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/pose.h"
#include "core/rotation.h"

namespace flextip {

/// The tip frame's pose as something other than this frame's picture says it (wrist and shaft
/// model, or motion).
struct TipPrediction {
  Pose T_RE;
  /// Of (dw, dp) in R (rad, m): the true pose is (exp([dw]x) R, p + dp).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Returns the standard deviation along the least certain direction.
inline double MaxSd(const Eigen::Matrix3d& covariance) {
  return std::sqrt(SymmetricEigenvalues(covariance)[2]);
}
inline double PositionSd(const TipPrediction& prediction) {
  return MaxSd(prediction.covariance.bottomRightCorner<3, 3>());
}
/// Returns the noise per axis (rad) of the tip's axis d, which turns by dw x d.
inline double DirectionNoise(const TipPrediction& prediction) {
  const Eigen::Matrix3d turn = Skew(prediction.T_RE.R.col(0));
  const Eigen::Matrix3d of_direction =
      turn * prediction.covariance.topLeftCorner<3, 3>() * turn.transpose();
  return std::sqrt(0.5 * of_direction.trace());
}

/// Returns how many standard deviations the place and direction of `a` are from those of `b`, of
/// both covariances together: the root of chi2 over five numbers. The roll about the shaft is left
/// out, for it may be unknown.
inline double Deviations(const TipPrediction& a, const TipPrediction& b) {
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(b.T_RE.R.col(0));
  Eigen::Matrix<double, 5, 1> apart;
  apart << across.transpose() * a.T_RE.R.col(0), a.T_RE.p - b.T_RE.p;
  Eigen::Matrix<double, 5, 5> sum = Eigen::Matrix<double, 5, 5>::Zero();
  for (const TipPrediction* one : {&a, &b}) {
    Eigen::Matrix<double, 5, 6> by_pose = Eigen::Matrix<double, 5, 6>::Zero();
    by_pose.topLeftCorner<2, 3>() = -across.transpose() * Skew(one->T_RE.R.col(0));
    by_pose.bottomRightCorner<3, 3>().setIdentity();
    sum += by_pose * one->covariance * by_pose.transpose();
  }
  return std::sqrt(std::max(0.0, MahalanobisSquared(apart, sum)));
}

}  // namespace flextip
