#include "calibration/camera/projection_derivative.h"

#include <ceres/jet.h>

#include <cassert>

#include "calibration/camera/lens_function.h"

namespace flextip {
namespace {

template <Distortion kModel, int kTerms>
ProjectionDerivative Differentiate(const CameraCalibration& camera, const Eigen::Vector3d& x_C) {
  constexpr int kIntrinsics = 4 + kTerms;
  using Jet = ceres::Jet<double, 3 + kIntrinsics>;
  const Eigen::VectorXd values = IntrinsicsVector(camera);
  assert(values.size() == kIntrinsics);
  Eigen::Matrix<Jet, 3, 1> x;
  for (int i = 0; i < 3; ++i) x[i] = Jet(x_C[i], i);
  Jet c[kIntrinsics];
  for (int i = 0; i < kIntrinsics; ++i) c[i] = Jet(values[i], 3 + i);
  const Eigen::Matrix<Jet, 2, 1> on_plane(x[0] / x[2], x[1] / x[2]);
  const Eigen::Matrix<Jet, 2, 1> bent = DistortLens<kModel, kTerms>(c + 4, on_plane);
  const Eigen::Matrix<Jet, 2, 1> at(c[0] * bent.x() + c[2], c[1] * bent.y() + c[3]);
  ProjectionDerivative d;
  d.by_intrinsics.resize(2, kIntrinsics);
  for (int row = 0; row < 2; ++row) {
    d.px[row] = at[row].a;
    d.by_point.row(row) = at[row].v.template head<3>();
    d.by_intrinsics.row(row) = at[row].v.template tail<kIntrinsics>();
  }
  return d;
}

}  // namespace

ProjectionDerivative DifferentiateProjection(const CameraCalibration& camera,
                                             const Eigen::Vector3d& x_C) {
  if (camera.distortion == Distortion::kEquidistant) {
    return Differentiate<Distortion::kEquidistant, 4>(camera, x_C);
  }
  switch (camera.distortion_coefficients.size()) {
    case 4:
      return Differentiate<Distortion::kRadialTangential, 4>(camera, x_C);
    case 5:
      return Differentiate<Distortion::kOpenCv, 5>(camera, x_C);
    case 8:
      return Differentiate<Distortion::kOpenCv, 8>(camera, x_C);
    default:
      return Differentiate<Distortion::kOpenCv, 12>(camera, x_C);
  }
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
