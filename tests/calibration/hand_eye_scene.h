// A robot, a camera and a board that are known exactly, seen with noise.
#pragma once

#include <functional>
#include <random>

#include "calibration/hand_eye/hand_eye.h"
#include "core/draw_vector.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip::hand_eye_test {

struct Scene {
  HandEyeMount mount = HandEyeMount::kEyeToHand;
  CameraCalibration camera;
  Pose T_FC, T_KB;
  int columns = 9, rows = 6;
  double square_m = 0.008;
  double corner_noise_px = 0.15, orientation_noise_rad = 1e-3, position_noise_m = 2e-4;
  double wrist_rate_hz = 100.0, frame_period_s = 0.31;
  double time_offset_s = 0.0;
  /// T_CB of the board over time.
  std::function<Pose(double)> board;
};

inline CameraCalibration Camera() {
  CameraCalibration c;
  c.width_px = 1280;
  c.height_px = 960;
  c.fu_px = 1100;
  c.fv_px = 1105;
  c.cu_px = 630;
  c.cv_px = 490;
  c.distortion_coefficients = {-0.1, 0.02, 0.0005, -0.0004};
  return c;
}

/// A board at `distance_m` that stands still at every picture, each time elsewhere, tilted by up to
/// `tilt_rad`; `at` moves by whole steps.
inline std::function<Pose(double)> Steps(double period_s, double distance_m, double tilt_rad,
                                         unsigned seed, const Eigen::Vector3d& middle_B) {
  return [=](double t) {
    std::mt19937 random(seed +
                        1000 * static_cast<unsigned>(std::lround(std::floor(t / period_s + 0.5))));
    std::uniform_real_distribution<double> u(-1, 1);
    Pose T;
    T.R = ExpRotation({tilt_rad * u(random), tilt_rad * u(random), 1.2 * tilt_rad * u(random)});
    const Eigen::Vector3d at = DrawVector<3>(u, random);
    T.p = distance_m * Eigen::Vector3d(0.2 * at.x(), 0.15 * at.y(), 1 + 0.15 * at.z()) -
          T.R * middle_B;
    return T;
  };
}

inline Eigen::Vector3d Middle(const Scene& s) {
  return {0.5 * (s.columns - 1) * s.square_m, 0.5 * (s.rows - 1) * s.square_m, 0};
}

inline Scene EyeToHand() {
  Scene s;
  s.camera = Camera();
  s.T_FC = {ExpRotation({0.4, -2.1, 0.9}), {0.5, -0.1, 0.35}};
  s.T_KB = {ExpRotation({-0.8, 0.5, 1.1}), {0.12, 0.03, -0.05}};
  s.board = Steps(s.frame_period_s, 0.25, 0.5, 7, Middle(s));
  return s;
}

inline Scene EyeInHand() {
  Scene s = EyeToHand();
  s.mount = HandEyeMount::kEyeInHand;
  s.T_FC = {ExpRotation({0.1, 0.2, -1.5}), {0.05, 0.02, 0.08}};
  s.T_KB = {ExpRotation({2.0, 0.3, 0.1}), {0.6, 0.2, 0.1}};
  return s;
}

/// The board moving all the time.
inline std::function<Pose(double)> Sweep(const Scene& s, double distance_m, double tilt_rad) {
  const Eigen::Vector3d middle_B = Middle(s);
  return [=](double t) {
    Pose T;
    T.R = ExpRotation({tilt_rad * std::sin(1.1 * t), tilt_rad * std::sin(1.7 * t + 1),
                       tilt_rad * std::sin(0.9 * t + 2)});
    T.p = distance_m * Eigen::Vector3d(0.15 * std::sin(0.8 * t), 0.12 * std::sin(1.3 * t + 0.5),
                                       1 + 0.12 * std::sin(0.6 * t)) -
          T.R * middle_B;
    return T;
  };
}

inline Pose WristOf(const Scene& s, double t) {
  const Pose T_FK = s.T_FC * s.board(t) * s.T_KB.Inverse();
  return s.mount == HandEyeMount::kEyeToHand ? T_FK : T_FK.Inverse();
}

/// `views` pictures; frames are stamped so that `time_offset_s` has to be added.
inline HandEyeInput Record(const Scene& s, int views, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sd) -> Eigen::Vector3d {
    return sd * DrawVector<3>(normal, random);
  };
  HandEyeInput input;
  input.mount = s.mount;
  input.camera = s.camera;
  input.wrist.rate_hz = s.wrist_rate_hz;
  input.wrist.orientation_noise_rad = s.orientation_noise_rad;
  input.wrist.position_noise_m = s.position_noise_m;
  const double end_s = (views + 1) * s.frame_period_s;
  for (int k = static_cast<int>(-s.wrist_rate_hz * s.frame_period_s); k < end_s * s.wrist_rate_hz;
       ++k) {
    const double t = k / s.wrist_rate_hz;
    const Pose T_RW = WristOf(s, t);
    const Eigen::Matrix3d R = ExpRotation(vector(s.orientation_noise_rad)) * T_RW.R;
    input.wrist.samples.push_back({static_cast<TimeNs>(std::llround(1e9 * t)),
                                   {T_RW.p + vector(s.position_noise_m), Eigen::Quaterniond(R)}});
  }
  const CameraModel model(s.camera);
  for (int i = 0; i < views; ++i) {
    const double t = i * s.frame_period_s;
    HandEyeView view{
        std::to_string(i), static_cast<TimeNs>(std::llround(1e9 * (t - s.time_offset_s))), {}};
    const Pose T_CB = s.board(t);
    for (int row = 0; row < s.rows; ++row) {
      for (int column = 0; column < s.columns; ++column) {
        const Eigen::Vector3d x_B(column * s.square_m, row * s.square_m, 0);
        view.sighting.x_B.push_back(x_B);
        view.sighting.ids.push_back(row * s.columns + column);
        view.sighting.px.push_back(model.Project(T_CB * x_B).value() +
                                   vector(s.corner_noise_px).head<2>());
      }
    }
    input.views.push_back(view);
  }
  return input;
}

}  // namespace flextip::hand_eye_test
