#include "calibration/camera/split.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calibration/camera/bundle.h"
#include "core/median.h"
#include "vision/camera_model.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

constexpr int kGrid = 15;  // points along each side
constexpr std::size_t kMinViews = 6;

std::optional<CameraSolution> Half(const CameraSolution& solution, std::size_t first) {
  CameraSolution half = solution;
  half.views.clear();
  for (std::size_t v = first; v < solution.views.size(); v += 2) {
    half.views.push_back(solution.views[v]);
  }
  if (!AdjustBundle(half, {.estimate_warp = solution.warp_estimated,
                           .estimate_shape = solution.shape.sd_m > 0})) {
    return {};
  }
  return half;
}

double MedianDistance(const CameraSolution& s) {
  std::vector<double> z;
  for (const SolvedView& view : s.views) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : view.x_B) middle += x / static_cast<double>(view.x_B.size());
    z.push_back((view.T_CB * middle).norm());
  }
  return Median(std::move(z));
}

}  // namespace

std::optional<ProjectionDifference> DifferenceOf(const CameraCalibration& a,
                                                 const CameraCalibration& b,
                                                 const Eigen::Vector2d& low_px,
                                                 const Eigen::Vector2d& high_px,
                                                 double distance_m) {
  constexpr int kIterations = 50;
  const CameraModel from(a), to(b);
  std::vector<Correspondence> points;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const int row = i / kGrid, column = i % kGrid;
    const Eigen::Array2d share = Eigen::Array2d(column, row) / (kGrid - 1);
    const Eigen::Vector2d px = low_px.array() + share * (high_px - low_px).array();
    const auto ray = from.Unproject(px);
    if (ray && to.Project(*ray)) points.push_back({*ray * distance_m, px});
  }
  if (points.size() < 8) return {};
  const auto nearest = MinimiseReprojection(to, points, Pose(), kIterations);
  if (!nearest) return {};
  ProjectionDifference difference;
  for (const Correspondence& p : points) {
    const auto px = to.Project(nearest->T_CE * p.x_E);
    if (!px) return {};
    const double d = (*px - p.px).norm();
    difference.rms_px += d * d / static_cast<double>(points.size());
    difference.max_px = std::max(difference.max_px, d);
  }
  difference.rms_px = std::sqrt(difference.rms_px);
  return difference;
}

std::optional<ProjectionDifference> SplitViews(const CameraSolution& solution) {
  if (solution.views.size() < kMinViews) return {};
  const auto even = Half(solution, 0), odd = Half(solution, 1);
  if (!even || !odd) return {};
  Eigen::Vector2d low = solution.views[0].px[0], high = low;
  for (const SolvedView& view : solution.views) {
    for (const Eigen::Vector2d& px : view.px) {
      low = low.cwiseMin(px);
      high = high.cwiseMax(px);
    }
  }
  return DifferenceOf(even->camera, odd->camera, low, high, MedianDistance(solution));
}

}  // namespace flextip
