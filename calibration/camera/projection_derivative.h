// A camera's projection with its derivatives by the point and by the lens.
#pragma once

#include <Eigen/Dense>

#include "core/camera.h"

namespace flextip {

struct ProjectionDerivative {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> by_point;                    ///< px/m, of x_C
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_intrinsics;  ///< fu, fv, cu, cv (px), coefficients
};

/// Of a point in front of the camera (z > 0), or of a direction: then z = 1 is as good as any.
ProjectionDerivative DifferentiateProjection(const CameraCalibration& camera,
                                             const Eigen::Vector3d& x_C);

/// fu, fv, cu, cv (px), then the coefficients: the order of all derivatives.
Eigen::VectorXd IntrinsicsVector(const CameraCalibration& camera);
/// `camera` with these in their place.
CameraCalibration WithIntrinsics(const CameraCalibration& camera, const Eigen::VectorXd& values);

}  // namespace flextip
