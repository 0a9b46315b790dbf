// Tip and pivot fitted to weighted poses, with the noise that they show.
#pragma once

#include <vector>

#include "calibration/tip/pivot.h"

namespace flextip {

/// Tip and pivot, and by how much the noise (variance) differs from what is stated.
struct PivotPoint {
  Eigen::Vector3d x_B = Eigen::Vector3d::Zero(), p_R = Eigen::Vector3d::Zero();
  double orientation_factor = 1.0, position_factor = 1.0;
};

/// R x + p - pivot.
Eigen::Vector3d PivotError(const PivotPose& pose, const PivotPoint& point);
/// Its covariance by the pose's noise, the orientation's with the lever R x.
Eigen::Matrix3d PivotErrorCovariance(const PivotPose& pose, const PivotPoint& point);
/// Its length in standard deviations.
double PivotSigmas(const PivotPose& pose, const PivotPoint& point);

/// Information of (tip, pivot) in the poses whose weight is not zero.
Matrix6d PivotInformation(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                          const PivotPoint& point);

/// One linear step (all errors alike): the start.
PivotPoint AlgebraicPivot(const std::vector<PivotPose>& poses, const std::vector<double>& weights);

/// Least absolute residuals from `start`, the noise as stated up to one factor.
PivotPoint RobustPivot(const std::vector<PivotPose>& poses, const PivotPoint& start);

/// What is found of the noise beside tip and pivot: nothing (the start's is kept), one factor, or
/// one for orientation and one for position.
enum class PivotNoise : std::uint8_t { kKept, kOneFactor, kTwoFactors };

/// Maximum likelihood with errors in position and orientation (the covariance of an error depends
/// on the tip, which takes off the bias that noisy orientations give a linear fit); the factors of
/// the noise by restricted maximum likelihood.
PivotPoint LikelyPivot(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                       const PivotPoint& start, PivotNoise noise);

}  // namespace flextip
