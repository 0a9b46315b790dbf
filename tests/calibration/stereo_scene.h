// A board before one camera or two, with all that is true of it; corners without pictures.
#pragma once

#include <random>

#include "calibration/boards/board.h"
#include "calibration/boards/chessboard.h"
#include "calibration/camera/solution.h"
#include "calibration/stereo/solution.h"
#include "calibration/stereo/stereo_calibration.h"
#include "core/draw_vector.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip {

struct StereoScene {
  BoardSpec board{.kind = BoardKind::kChessboard,
                  .columns = 8,
                  .rows = 6,
                  .square_m = 0.005,
                  .marker_m = 0,
                  .dictionary = {}};
  std::array<CameraCalibration, 2> cameras;
  Pose T_C0C1;
  BoardWarp warp;
  std::vector<Pose> T_C0B;

  std::vector<Eigen::Vector3d> Points() const {
    return ChessboardPoints(board.columns, board.rows, board.square_m);
  }

  /// What camera `eye` sees of the board at T_C0B, exactly.
  SolvedView See(std::size_t index, int eye, const Pose& T_C0B_) const {
    const CameraModel model(cameras[eye]);
    SolvedView view;
    view.index = index;
    view.T_CB = eye == 0 ? T_C0B_ : T_C0C1.Inverse() * T_C0B_;
    for (const Eigen::Vector3d& x : Points()) {
      const auto px = model.Project(view.T_CB * warp.Bent(x));
      view.ids.push_back(static_cast<int>(view.ids.size()));
      view.x_B.push_back(x);
      view.px.push_back(px.value());
      view.reason.emplace_back();
    }
    return view;
  }

  StereoSolution Exact() const {
    StereoSolution s;
    s.cameras = cameras;
    s.T_C0C1 = T_C0C1;
    s.warp = warp;
    for (std::size_t i = 0; i < T_C0B.size(); ++i) {
      s.views.push_back({i, T_C0B[i], {See(i, 0, T_C0B[i]), See(i, 1, T_C0B[i])}});
    }
    return s;
  }

  CameraSolution ExactCamera() const {
    CameraSolution s;
    s.camera = cameras[0];
    s.warp = warp;
    for (std::size_t i = 0; i < T_C0B.size(); ++i) s.views.push_back(See(i, 0, T_C0B[i]));
    return s;
  }
};

inline void AddNoise(double sd_px, std::mt19937& random, SolvedView& view) {
  std::normal_distribution<double> noise(0, sd_px);
  for (Eigen::Vector2d& px : view.px) px += DrawVector<2>(noise, random);
}

inline Pose RandomBoardPose(const StereoScene& scene, std::mt19937& random, double depth_m = 0.10) {
  std::uniform_real_distribution<double> u(-1, 1);
  const Eigen::Vector3d centre =
      Eigen::Vector3d(scene.warp.centre_m.x(), scene.warp.centre_m.y(), 0);
  Pose T;
  T.R = ExpRotation({0.6 * u(random), 0.6 * u(random), 0.3 * u(random)});
  const Eigen::Vector3d at = DrawVector<3>(u, random);
  T.p =
      Eigen::Vector3d(0.010 * at.x(), 0.008 * at.y(), depth_m * (1 + 0.2 * at.z())) - T.R * centre;
  return T;
}

/// Two cameras 12 mm apart, before a board that fills about half of the picture.
inline StereoScene MakeStereoScene(int views, unsigned seed) {
  StereoScene scene;
  for (int eye = 0; eye < 2; ++eye) {
    CameraCalibration& c = scene.cameras[eye];
    c.width_px = 800;
    c.height_px = 600;
    c.fu_px = 900 + 10 * eye;
    c.fv_px = 905 + 10 * eye;
    c.cu_px = 404 - 6 * eye;
    c.cv_px = 296 + 4 * eye;
    c.distortion_coefficients = {-0.2 - 0.02 * eye, 0.05, 0.001, -0.0005};
  }
  scene.T_C0C1 = {ExpRotation({0.01, -0.05, 0.005}), {0.012, 0.0003, -0.0004}};
  scene.warp.centre_m = 0.5 * Eigen::Vector2d(7 * 0.005, 5 * 0.005);
  scene.warp.half_m = scene.warp.centre_m;
  std::mt19937 random(seed);
  for (int i = 0; i < views; ++i) scene.T_C0B.push_back(RandomBoardPose(scene, random));
  return scene;
}

}  // namespace flextip
