#include "calibration/uncertainty/camera_uncertainty.h"

#include <cmath>

namespace flextip {
namespace {

constexpr std::size_t kNextViews = 3;

CameraUncertainty Mapped(const ProjectionUncertainty& uncertainty, double depth_m) {
  return {.near = MapUncertainty(uncertainty, depth_m),
          .far = MapUncertainty(uncertainty, HUGE_VAL),
          .next = {}};
}

}  // namespace

std::optional<CameraUncertainty> FindUncertainty(const CameraSolution& solution,
                                                 const std::vector<Eigen::Vector3d>& x_B) {
  const auto uncertainty = ProjectionUncertainty::Of(solution);
  if (!uncertainty) return {};
  const double depth_m = MedianBoardDepth(solution);
  CameraUncertainty u = Mapped(*uncertainty, depth_m);
  if (x_B.empty()) return u;
  u.next = RankNextViews(*uncertainty, CandidateViews(solution, x_B), x_B, {.depth_m = depth_m});
  if (u.next.size() > kNextViews) u.next.resize(kNextViews);
  return u;
}

std::optional<CameraUncertainty> FindUncertainty(const StereoSolution& solution, int eye) {
  const auto uncertainty = ProjectionUncertainty::Of(solution, eye);
  if (!uncertainty) return {};
  return Mapped(*uncertainty, MedianBoardDepth(solution, eye));
}

}  // namespace flextip
