// One shaft, and what any set of sensors says of it.
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "core/rotation.h"
#include "estimation/shaft_estimator.h"
#include "kinematics/rod.h"

namespace flextip {

inline constexpr double kBenchLength = 0.6, kBenchStiffness = 0.304;
inline const Eigen::Vector3d kBenchPort(0.28, 0.0, 0.0);
inline const Eigen::Vector3d kBenchForce(0.3, -1.2, 0.5);

inline RodProblem BenchShaft() {
  return {kBenchLength, kBenchStiffness, {0, 0, 0}, kBenchPort, kBenchForce, {0, 0, 0}};
}

enum Sensors {
  kWristDirection = 1,
  kTip = 2,
  kTipDirection = 4,
  kEm = 8,
  kStrain = 16,
  kLoad = 32,
  kPortDirection = 64
};

/// Measurements of the rod itself (the estimator's own model: what is tested here is the fit, its
/// covariance and its status; models against another physics meet in the closed loop's tests).
class SensorBench {
 public:
  Measurements Measure(const RodProblem& problem, int sensors, double noise_scale) {
    RodSolver solver;
    const RodState rod = solver.Solve(problem);
    EXPECT_TRUE(rod.IsUsable());
    Measurements z;
    z.wrist_position_noise_m = 5e-5;
    z.p_RW = problem.p_wrist + noise_scale * 5e-5 * Normal();
    const Eigen::Matrix3d R_RW = RotationWithoutTwist(Eigen::Vector3d::UnitX(), rod.wrist.t);
    if (sensors & (kWristDirection | kStrain)) {
      z.R_RW = ExpRotation(noise_scale * 3e-4 * Normal()) * R_RW;
      z.wrist_orientation_noise_rad = 3e-4;
    }
    if (sensors & (kTip | kTipDirection)) {
      z.tip.emplace();
      z.tip->status = TipStatus::kOk;
      const Eigen::Vector3d sd(1e-4, 2e-4, 5e-4);
      z.tip->covariance_m2 = sd.cwiseAbs2().asDiagonal();
      z.tip->p_RE = rod.tip.p + noise_scale * sd.cwiseProduct(Normal());
      if (sensors & kTipDirection) {
        z.tip->d_RE = ExpRotation(noise_scale * 3e-3 * Normal()) * rod.tip.t;
        z.tip_direction_noise_rad = 3e-3;
      }
    }
    if (sensors & kEm) {
      const RodSection s = solver.Section(kBenchLength - 0.02);
      z.em.emplace();
      z.em->distance_from_tip_m = 0.02;
      z.em->position_noise_m = 1.3e-4;
      z.em->orientation_noise_rad = 5.6e-4;
      z.em->T_RS = {ExpRotation(noise_scale * 5.6e-4 * Normal()) *
                        RotationWithoutTwist(Eigen::Vector3d::UnitX(), s.t),
                    s.p + noise_scale * 1.3e-4 * Normal()};
    }
    if (sensors & kPortDirection) {
      z.port_direction = ExpRotation(noise_scale * 5.6e-4 * Normal()) * rod.t_port;
      z.port_direction_noise_rad = 5.6e-4;
    }
    if (sensors & kStrain) AddStrain(solver, R_RW, noise_scale, z);
    if (sensors & kLoad)
      z.load = LoadMeasurement{problem.f_tip + noise_scale * 0.005 * Normal(), 0.005};
    return z;
  }

 private:
  /// The carried frame by small steps along the shaft, unlike the estimator's two rotations.
  void AddStrain(RodSolver& solver, const Eigen::Matrix3d& R_RW, double noise_scale,
                 Measurements& z) {
    z.strain.emplace();
    z.strain->moment_noise_Nm = 8e-4;
    const double stations[2] = {0.12, 0.5};
    Eigen::Matrix3d frame = R_RW;
    const int steps = 300;
    int next = 0;
    for (int i = 1; i <= steps && next < 2; ++i) {
      const double s = stations[1] * i / steps;
      const RodSection section = solver.Section(s);
      frame = RotationWithoutTwist(frame.col(0), section.t) * frame;
      if (s < stations[next] - 1e-9) continue;
      z.strain->station_from_wrist_m[next] = s;
      z.strain->moments_Nm.segment<2>(2 * next) =
          frame.rightCols<2>().transpose() * section.m + noise_scale * 8e-4 * Normal().head<2>();
      ++next;
    }
  }
  Eigen::Vector3d Normal() { return {normal_(rng_), normal_(rng_), normal_(rng_)}; }

  std::mt19937_64 rng_{11};
  std::normal_distribution<double> normal_;
};

inline EstimatorOptions BenchOptions(bool use_positions = true) {
  EstimatorOptions options;
  options.instrument = {kBenchLength, 0.00238, kBenchStiffness, 0.0};
  options.p_RP = kBenchPort;
  options.use_positions = use_positions;
  return options;
}

struct SensorSet {
  const char* name;
  int sensors;
  bool use_positions;
};
inline const SensorSet kSets[] = {
    {"wrist direction, tip", kWristDirection | kTip, true},
    {"wrist direction, tip and its direction", kWristDirection | kTip | kTipDirection, true},
    {"wrist direction, EM", kWristDirection | kEm, true},
    {"wrist direction, EM orientation only", kWristDirection | kEm, false},
    {"strain", kStrain, false},
    {"strain, tip", kStrain | kTip, true},
    {"load", kLoad, false},
    {"everything", 127, true},
};

}  // namespace flextip
