// Boards drawn as a known camera sees them, area-sampled, blurred and with noise.
#pragma once

#include <opencv2/imgproc.hpp>
#include <random>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "vision/camera_model.h"

namespace flextip {

/// The board's face: `cells_per_unit` pixels of it are one unit of the board.
struct BoardTexture {
  cv::Mat_<std::uint8_t> face;
  double cells_per_unit = 1.0;
};

/// Black and white squares, a black one first; a square is a unit.
inline BoardTexture ChessboardTexture(int columns, int rows) {
  BoardTexture t{cv::Mat_<std::uint8_t>(rows, columns), 1.0};
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) t.face(y, x) = (x + y) % 2 == 0 ? 0 : 255;
  }
  return t;
}

/// `unit_m` is a unit's side, `origin` where frame B's origin is on the face, in units.
inline Image DrawBoard(const CameraCalibration& camera, const Pose& T_CB, const BoardTexture& board,
                       double unit_m, const Eigen::Vector2d& origin, unsigned seed) {
  constexpr int kSubPixels = 6;
  const CameraModel model(camera);
  const Pose T_BC = T_CB.Inverse();
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 2);
  // Where the board's plane is seen at the pixels' corners; linear in between.
  cv::Mat_<cv::Vec2d> on_board(camera.height_px + 1, camera.width_px + 1);
  for (int y = 0; y <= camera.height_px; ++y) {
    for (int x = 0; x <= camera.width_px; ++x) {
      const Eigen::Vector3d ray = T_BC.R * model.Unproject({x - 0.5, y - 0.5}).value();
      const Eigen::Vector3d at = T_BC.p - ray * (T_BC.p.z() / ray.z());
      on_board(y, x) = {(at.x() / unit_m + origin.x()) * board.cells_per_unit,
                        (at.y() / unit_m + origin.y()) * board.cells_per_unit};
    }
  }
  cv::Mat_<float> canvas(camera.height_px, camera.width_px);
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      double sum = 0;
      for (int k = 0; k < kSubPixels * kSubPixels; ++k) {
        const double a = (k % kSubPixels + 0.5) / kSubPixels,
                     b = (k / kSubPixels + 0.5) / kSubPixels;
        const cv::Vec2d at = (1 - b) * ((1 - a) * on_board(y, x) + a * on_board(y, x + 1)) +
                             b * ((1 - a) * on_board(y + 1, x) + a * on_board(y + 1, x + 1));
        const bool inside =
            at[0] >= 0 && at[1] >= 0 && at[0] < board.face.cols && at[1] < board.face.rows;
        sum +=
            inside && board.face(static_cast<int>(at[1]), static_cast<int>(at[0])) < 128 ? 40 : 200;
      }
      canvas(y, x) = static_cast<float>(sum / (kSubPixels * kSubPixels));
    }
  }
  cv::GaussianBlur(canvas, canvas, cv::Size(0, 0), 0.7);
  Image image(camera.width_px, camera.height_px, 1);
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      const double grey = std::clamp(canvas(y, x) + noise(random), 0.0, 255.0);
      image.Row(y)[x] = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return image;
}

}  // namespace flextip
