// Boards as a camera that is known sees them.
#pragma once

#include <fmt/format.h>

#include <random>
#include <vector>

#include "calibration/camera/camera_calibration.h"
#include "core/draw_vector.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip {

inline CameraCalibration KnownCamera() {
  CameraCalibration c;
  c.width_px = 640;
  c.height_px = 480;
  c.fu_px = 520;
  c.fv_px = 524;
  c.cu_px = 328;
  c.cv_px = 236;
  c.distortion_coefficients = {-0.28, 0.09, 0.001, -0.0005};
  return c;
}

// Corners of a 9x6 board of 25 mm squares, `bulge_m` bent, as `camera` sees them with noise.
struct Synthetic {
  CameraCalibration camera = KnownCamera();
  Eigen::Vector2d bulge_m = Eigen::Vector2d::Zero();
  double noise_px = 0.1, tilt_rad = 0.5;
  double depth_m = 0.32;  ///< of the board's middle, in the mean
  int views = 12;
};

inline std::vector<BoardView> Seen(const Synthetic& s, unsigned seed) {
  const BoardSpec board = ParseBoardSpec("chessboard:9x6:0.025");
  const auto corners = BoardCorners(board);
  const auto [low, high] = BoardExtent(board);
  const BoardWarp warp{s.bulge_m, 0.5 * (low + high), 0.5 * (high - low)};
  const CameraModel model(s.camera);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::normal_distribution<double> noise(0, s.noise_px);
  std::vector<BoardView> views;
  while (static_cast<int>(views.size()) < s.views) {
    Pose T_CB;
    T_CB.R = ExpRotation({s.tilt_rad * u(random), s.tilt_rad * u(random), 0.4 * u(random)});
    const Eigen::Vector3d at = DrawVector<3>(u, random);
    T_CB.p = Eigen::Vector3d(0.08 * at.x(), 0.06 * at.y(), s.depth_m + 0.08 * at.z()) -
             T_CB.R * Eigen::Vector3d(0.1, 0.0625, 0);
    BoardView view{fmt::format("view {}", views.size()), {}};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto px = model.Project(T_CB * warp.Bent(corners[i]));
      if (!px) break;
      view.sighting.ids.push_back(static_cast<int>(i));
      view.sighting.x_B.push_back(corners[i]);
      view.sighting.px.push_back(*px + DrawVector<2>(noise, random));
    }
    if (view.sighting.ids.size() == corners.size()) views.push_back(view);
  }
  return views;
}

// The solution that `views` were made with; `poses` are where a search without noise ends.
inline CameraSolution AtTruth(const Synthetic& truth, const std::vector<BoardView>& views,
                              const std::vector<SolvedView>& poses) {
  const auto [low, high] = BoardExtent(ParseBoardSpec("chessboard:9x6:0.025"));
  CameraSolution s;
  s.camera = truth.camera;
  s.warp = {truth.bulge_m, 0.5 * (low + high), 0.5 * (high - low)};
  for (std::size_t v = 0; v < views.size(); ++v) {
    SolvedView view;
    view.index = v;
    view.ids = views[v].sighting.ids;
    view.x_B = views[v].sighting.x_B;
    view.px = views[v].sighting.px;
    view.reason.resize(view.px.size());
    if (!poses.empty()) view.T_CB = poses[v].T_CB;
    s.views.push_back(view);
  }
  return s;
}

inline Eigen::VectorXd Intrinsics(const CameraCalibration& c) {
  Eigen::VectorXd v(4 + static_cast<int>(c.distortion_coefficients.size()));
  v << c.fu_px, c.fv_px, c.cu_px, c.cv_px,
      Eigen::Map<const Eigen::VectorXd>(c.distortion_coefficients.data(), v.size() - 4);
  return v;
}

}  // namespace flextip
