#include "calibration/entries.h"

#include <fmt/format.h>

namespace flextip {
namespace {

std::vector<double> Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// Places in the solution's covariance, in the order of Calibration::CoordinateNames: the pose, then
// by name each camera's coefficients and intrinsics.
std::vector<int> PlacesByName(const StereoSolution& s) {
  std::vector<int> places;
  const auto add = [&](int first, int count) {
    for (int i = 0; i < count; ++i) places.push_back(first + i);
  };
  add(s.PairStart(), 6);
  for (int eye = 0; eye < 2; ++eye) {
    const int first = eye == 0 ? 0 : s.IntrinsicsCount(0);
    add(first + 4, s.IntrinsicsCount(eye) - 4);
    add(first, 4);
  }
  return places;
}

}  // namespace

Calibration CameraEntries(const CameraCalibrationResult& r) {
  Calibration entries;
  entries.kind = "camera";
  AddLens("cam0", r.solution.camera, entries);
  const int n = r.solution.IntrinsicsCount(), terms = n - 4;
  entries.covariance.resize(n, n);
  entries.covariance << r.covariance.block(4, 4, terms, terms), r.covariance.block(4, 0, terms, 4),
      r.covariance.block(0, 4, 4, terms), r.covariance.topLeftCorner(4, 4);
  return entries;
}

Calibration StereoEntries(const StereoResult& r) {
  Calibration entries;
  entries.kind = "stereo";
  entries.poses["cam1.T_C0C1"] = r.solution.T_C0C1;
  for (int eye = 0; eye < 2; ++eye) {
    AddLens(fmt::format("cam{}", eye), r.solution.cameras[eye], entries);
  }
  const std::vector<int> places = PlacesByName(r.solution);
  entries.covariance = r.covariance(places, places);
  return entries;
}

Calibration TipEntries(const PivotResult& result, const std::string& tip_name) {
  Calibration entries;
  entries.kind = "tip";
  if (!result.IsUsable()) {
    entries.unobservable = {{tip_name, result.unobservable}, {"pivot.p_R", result.unobservable}};
    return entries;
  }
  entries.numbers[tip_name] = Numbers(result.p_BE);
  entries.numbers["pivot.p_R"] = Numbers(result.p_R);
  entries.covariance.setZero(6, 6);
  const int tip = entries.RangeOf(tip_name).first, pivot = entries.RangeOf("pivot.p_R").first;
  const Matrix6d& C = result.covariance;
  entries.covariance.block<3, 3>(tip, tip) = C.topLeftCorner<3, 3>();
  entries.covariance.block<3, 3>(tip, pivot) = C.topRightCorner<3, 3>();
  entries.covariance.block<3, 3>(pivot, tip) = C.bottomLeftCorner<3, 3>();
  entries.covariance.block<3, 3>(pivot, pivot) = C.bottomRightCorner<3, 3>();
  return entries;
}

Calibration EmEntries(const EmResult& result) {
  Calibration entries;
  entries.kind = "em";
  entries.unobservable = result.unobservable;
  if (!result.IsUsable()) return entries;
  const EmSolution& s = result.solution;
  entries.poses["em0.T_RF"] = s.T_RF;
  if (result.design.free_distance) entries.numbers["em0.distance_from_tip_m"] = {s.distance_m};
  if (result.design.basis.kind != FieldKind::kNone) {
    entries.numbers["em0.field"] = s.field.coefficients;
    entries.numbers["em0.field_centre_m"] = Numbers(s.field.centre_m);
    entries.numbers["em0.field_scale_m"] = Numbers(s.field.scale_m);
  }
  // The order is that of the solution: registration, distance, field; the box is exact.
  const auto n = static_cast<Eigen::Index>(entries.CoordinateNames().size());
  entries.covariance.setZero(n, n);
  entries.covariance.topLeftCorner(s.covariance.rows(), s.covariance.cols()) = s.covariance;
  return entries;
}

}  // namespace flextip
