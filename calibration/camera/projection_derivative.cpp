#include "calibration/camera/projection_derivative.h"

#include "calibration/camera/lens_derivative.h"

namespace flextip {

ProjectionDerivative DifferentiateProjection(const CameraCalibration& camera,
                                             const Eigen::Vector3d& x_C) {
  const auto& k = camera.distortion_coefficients;
  const int terms = static_cast<int>(k.size());
  const Eigen::Vector2d m = x_C.head<2>() / x_C.z();
  const LensDerivative lens = DifferentiateLens(camera.distortion, k.data(), terms, m);
  const Eigen::Vector2d focal_px(camera.fu_px, camera.fv_px);
  Eigen::Matrix<double, 2, 3> m_by_x;
  m_by_x << 1, 0, -m.x(), 0, 1, -m.y();
  ProjectionDerivative d;
  d.px = focal_px.cwiseProduct(lens.d) + Eigen::Vector2d(camera.cu_px, camera.cv_px);
  d.by_point = focal_px.asDiagonal() * lens.by_m * m_by_x / x_C.z();
  d.by_intrinsics.setZero(2, 4 + terms);
  d.by_intrinsics(0, 0) = lens.d.x();
  d.by_intrinsics(1, 1) = lens.d.y();
  d.by_intrinsics(0, 2) = d.by_intrinsics(1, 3) = 1.0;
  for (int i = 0; i < terms; ++i) {
    d.by_intrinsics.col(4 + i) = focal_px.cwiseProduct(lens.by_k.col(i));
  }
  return d;
}

Eigen::VectorXd IntrinsicsVector(const CameraCalibration& camera) {
  const auto& k = camera.distortion_coefficients;
  Eigen::VectorXd values(4 + static_cast<Eigen::Index>(k.size()));
  values.head<4>() << camera.fu_px, camera.fv_px, camera.cu_px, camera.cv_px;
  for (std::size_t i = 0; i < k.size(); ++i) values[4 + static_cast<Eigen::Index>(i)] = k[i];
  return values;
}

CameraCalibration WithIntrinsics(const CameraCalibration& camera, const Eigen::VectorXd& values) {
  CameraCalibration moved = camera;
  moved.fu_px = values[0];
  moved.fv_px = values[1];
  moved.cu_px = values[2];
  moved.cv_px = values[3];
  moved.distortion_coefficients.assign(values.data() + 4, values.data() + values.size());
  return moved;
}

}  // namespace flextip
