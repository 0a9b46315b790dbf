// An EM sensor on a shaft that goes through a port, with a known registration and field.
#pragma once

#include <functional>
#include <random>
#include <vector>

#include "calibration/em/pairs.h"
#include "core/draw_vector.h"
#include "core/rotation.h"

namespace flextip {

struct EmScene {
  int pairs = 400;
  double length_m = 0.6, distance_m = 0.03;
  Eigen::Vector3d p_RP{0.28, 0.0, 0.0};
  double cone_rad = 0.35, insertion_m = 0.06;  ///< half the width, uniform
  double lean_rad = 0.0;  ///< direction of the shaft besides the chord: as a load would bend it
  Pose T_RF{ExpRotation({0.3, -0.8, 1.1}), {0.2, 0.4, -0.1}};
  double em_noise_m = 4e-4, reference_noise_m = 2e-4;
  double em_true = 1.0;  ///< true noise of the sensor over the stated one
  /// The true position for a measured one, in R.
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> corrected = [](const Eigen::Vector3d& p) {
    return p;
  };
};

/// Solves corrected(p) = x: what the sensor measures.
inline Eigen::Vector3d Distorted(const EmScene& scene, const Eigen::Vector3d& x) {
  Eigen::Vector3d p = x;
  for (int i = 0; i < 30; ++i) p += x - scene.corrected(p);
  return p;
}

inline std::vector<EmPair> DrawEm(const EmScene& scene, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto draw = [&] { return DrawVector<3>(normal, random); };
  std::vector<EmPair> pairs;
  for (int i = 0; i < scene.pairs; ++i) {
    const Eigen::Matrix3d R =
        ExpRotation({0, scene.cone_rad * uniform(random), scene.cone_rad * uniform(random)});
    const double inserted = 0.22 + scene.insertion_m * uniform(random);
    const Eigen::Vector3d p_RE = scene.p_RP + inserted * R.col(0);
    const Eigen::Matrix3d R_E =
        ExpRotation({0, scene.lean_rad * uniform(random), scene.lean_rad * uniform(random)}) * R;
    const Eigen::Vector3d p_RS = p_RE - scene.distance_m * R_E.col(0);
    EmPair pair;
    pair.t_ns = i * TimeNs{20'000'000};
    pair.T_FS.p =
        scene.T_RF.Inverse() * Distorted(scene, p_RS) + scene.em_true * scene.em_noise_m * draw();
    pair.T_FS.R = scene.T_RF.R.transpose() * R_E;
    pair.p_RE = p_RE + scene.reference_noise_m * draw();
    pair.t_RE = R_E.col(0);
    pair.covariance =
        (scene.em_noise_m * scene.em_noise_m + scene.reference_noise_m * scene.reference_noise_m) *
        Eigen::Matrix3d::Identity();
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace flextip
