#include "calibration/camera/camera_board_shape.h"

#include <algorithm>
#include <cmath>

#include "calibration/camera/camera_bundle.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

constexpr int kRounds = 60;
constexpr double kStill_m = 1e-7;

struct Normal {
  Eigen::Matrix3d JtJ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d Jtr = Eigen::Vector3d::Zero();
};

// Of every corner's offset, over all views that use it; residuals are as seen less predicted.
std::map<int, Normal> NormalEquations(const CameraSolution& s) {
  const CameraModel camera(s.camera);
  std::map<int, Normal> normals;
  for (const SolvedView& view : s.views) {
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      Eigen::Matrix<double, 2, 3> J_C;
      const auto px = camera.Project(view.T_CB * s.warp.Bent(view.x_B[i]), &J_C);
      if (!px || !view.IsUsed(i)) continue;
      const Eigen::Matrix<double, 2, 3> J = J_C * view.T_CB.R;
      Normal& n = normals[view.ids[i]];
      n.JtJ += J.transpose() * J;
      n.Jtr += J.transpose() * (view.px[i] - *px);
    }
  }
  return normals;
}

}  // namespace

void MoveCorners(const BoardShape& shape, SolvedView& view) {
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const auto at = shape.find(view.ids[i]);
    if (at != shape.end()) view.x_B[i] += at->second;
  }
}

std::pair<double, double> SizeOf(const BoardShape& shape) {
  double squares = 0.0, longest = 0.0;
  for (const auto& [id, offset] : shape) {
    squares += offset.squaredNorm();
    longest = std::max(longest, offset.norm());
  }
  return {shape.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(shape.size())), longest};
}

std::optional<BoardShape> AdjustBoardShape(CameraSolution& solution, double sd_m) {
  CameraSolution s = solution;
  const BundleOptions options{.estimate_warp = solution.warp_estimated, .max_iterations = 10};
  BoardShape shape;
  for (int round = 0; round < kRounds; ++round) {
    const double information = s.noise_px * s.noise_px / (sd_m * sd_m);  // in px^2 / m^2
    BoardShape step;
    double longest = 0.0;
    for (const auto& [id, n] : NormalEquations(s)) {
      const Eigen::Matrix3d A = n.JtJ + information * Eigen::Matrix3d::Identity();
      Eigen::Vector3d& offset = shape.try_emplace(id, Eigen::Vector3d::Zero()).first->second;
      const Eigen::Vector3d by = A.ldlt().solve(n.Jtr - information * offset);
      offset += by;
      step[id] = by;
      longest = std::max(longest, by.norm());
    }
    for (SolvedView& view : s.views) MoveCorners(step, view);
    if (!AdjustBundle(s, options)) return {};
    if (longest < kStill_m) break;
  }
  const double before = 2.0 * s.CornersUsed() - s.Size(),
               after = std::max(1.0, before - 3.0 * static_cast<double>(shape.size()));
  s.noise_px *= std::sqrt(std::max(1.0, before) / after);
  solution = std::move(s);
  return shape;
}

}  // namespace flextip
