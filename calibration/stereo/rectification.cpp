#include "calibration/stereo/rectification.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

// What of a picture's frame is seen on the rectified plane z = 1 at least, and at most.
struct Extent {
  Eigen::Vector2d inner_low, inner_high, outer_low, outer_high;
};

std::optional<Eigen::Vector2d> OnPlane(const CameraModel& model, const Eigen::Matrix3d& R,
                                       const Eigen::Vector2d& px) {
  const auto ray = model.Unproject(px);
  if (!ray) return {};
  const Eigen::Vector3d turned = R * *ray;
  if (turned.z() < 1e-3) return {};
  return turned.hnormalized();
}

// Empty where the lens model does not reach the picture's edge everywhere.
std::optional<Extent> ExtentOf(const CameraCalibration& camera, const Eigen::Matrix3d& R) {
  const CameraModel model(camera);
  const double w = camera.width_px - 1.0, h = camera.height_px - 1.0;
  constexpr int kSteps = 20;
  Extent e{Eigen::Vector2d::Constant(-HUGE_VAL), Eigen::Vector2d::Constant(HUGE_VAL),
           Eigen::Vector2d::Constant(HUGE_VAL), Eigen::Vector2d::Constant(-HUGE_VAL)};
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const auto left = OnPlane(model, R, {0, t * h}), right = OnPlane(model, R, {w, t * h});
    const auto top = OnPlane(model, R, {t * w, 0}), bottom = OnPlane(model, R, {t * w, h});
    if (!left || !right || !top || !bottom) return {};
    e.inner_low = e.inner_low.cwiseMax(Eigen::Vector2d(left->x(), top->y()));
    e.inner_high = e.inner_high.cwiseMin(Eigen::Vector2d(right->x(), bottom->y()));
    for (const auto& p : {*left, *right, *top, *bottom}) {
      e.outer_low = e.outer_low.cwiseMin(p);
      e.outer_high = e.outer_high.cwiseMax(p);
    }
  }
  if ((e.inner_high - e.inner_low).minCoeff() <= 0) return {};
  return e;
}

}  // namespace

Eigen::Matrix4d Rectification::Q() const {
  const double f = P[0](0, 0), cu = P[0](0, 2), cv = P[0](1, 2);
  Eigen::Matrix4d Q = Eigen::Matrix4d::Zero();
  Q(0, 0) = Q(1, 1) = 1.0;
  Q(0, 3) = -cu;
  Q(1, 3) = -cv;
  Q(2, 3) = f;
  Q(3, 2) = 1.0 / baseline_m;
  return Q;
}

Rectification Rectify(const std::array<CameraCalibration, 2>& cameras, const Pose& T_C0C1) {
  const Eigen::Vector3d along = T_C0C1.p.normalized();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ() + T_C0C1.R.col(2);
  const Eigen::Vector3d down = axis.cross(along);
  if (!(T_C0C1.p.norm() > 0) || !(down.norm() > 0.2)) {
    throw InputError("stereo: the cameras look along their baseline and cannot be rectified");
  }
  Rectification r;
  r.baseline_m = T_C0C1.p.norm();
  r.R[0].row(0) = along;
  r.R[0].row(1) = down.normalized();
  r.R[0].row(2) = along.cross(down.normalized());
  r.R[1] = r.R[0] * T_C0C1.R;

  // Both pictures the same size and scale; the columns' centre is where both see.
  double f = 0.25 * (cameras[0].fu_px + cameras[0].fv_px + cameras[1].fu_px + cameras[1].fv_px);
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  const auto e0 = ExtentOf(cameras[0], r.R[0]), e1 = ExtentOf(cameras[1], r.R[1]);
  if (e0 && e1) {
    const Eigen::Vector2d low = e0->inner_low.cwiseMax(e1->inner_low);
    const Eigen::Vector2d high = e0->inner_high.cwiseMin(e1->inner_high);
    const Eigen::Vector2d size(cameras[0].width_px, cameras[0].height_px);
    if ((high - low).minCoeff() > 0) {
      centre = 0.5 * (low + high);
      f = (size.array() / (high - low).array()).maxCoeff();
    }
  }
  const double cu = 0.5 * (cameras[0].width_px - 1) - f * centre.x();
  const double cv = 0.5 * (cameras[0].height_px - 1) - f * centre.y();
  for (auto& P : r.P) P << f, 0, cu, 0, 0, f, cv, 0, 0, 0, 1, 0;
  r.P[1](0, 3) = -f * r.baseline_m;
  return r;
}

std::optional<Eigen::Vector2d> RectifiedPixel(const Rectification& rectification, int eye,
                                              const CameraCalibration& camera,
                                              const Eigen::Vector2d& px) {
  const auto at = OnPlane(CameraModel(camera), rectification.R[eye], px);
  if (!at) return {};
  const auto& P = rectification.P[eye];
  return Eigen::Vector2d(P(0, 0) * at->x() + P(0, 2), P(1, 1) * at->y() + P(1, 2));
}

}  // namespace flextip
