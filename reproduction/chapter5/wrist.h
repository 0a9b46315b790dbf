// The patient-side robot's wrist under proportional-derivative control (5.2.6). Private to
// reproduction.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace flextip::reproduction {

/// A desktop robot as its data sheet has it (Phantom Premium 1.5: apparent inertia under 75 g),
/// with the rod; gains that its servo keeps stable. Gravity is compensated.
struct ServoWristSetup {
  double mass_kg = 0.1;
  double stiffness_N_m = 1000.0;
  double damping_ratio = 1.0;
};

class ServoWrist {
 public:
  /// At rest at `p_RW`. `f_rest_N`: the load on the arm that gravity compensation carries.
  ServoWrist(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& f_rest_N,
             const ServoWristSetup& setup = {})
      : setup_(setup), f_rest_N_(f_rest_N), p_RW_(p_RW) {}

  /// Moves for `dt_s` toward `command` with the load `f_arm_N` on the arm.
  void Move(const Eigen::Vector3d& command, const Eigen::Vector3d& f_arm_N, double dt_s) {
    const double damping =
        2.0 * setup_.damping_ratio * std::sqrt(setup_.stiffness_N_m * setup_.mass_kg);
    const int parts = std::max(1, static_cast<int>(std::ceil(dt_s * kServo_hz)));
    for (int i = 0; i < parts; ++i) {
      const Eigen::Vector3d force =
          setup_.stiffness_N_m * (command - p_RW_) - damping * v_RW_ + f_arm_N - f_rest_N_;
      v_RW_ += dt_s / parts / setup_.mass_kg * force;
      p_RW_ += dt_s / parts * v_RW_;
    }
  }

  const Eigen::Vector3d& Position() const { return p_RW_; }

 private:
  static constexpr double kServo_hz = 2000.0;
  ServoWristSetup setup_;
  Eigen::Vector3d f_rest_N_, p_RW_, v_RW_ = Eigen::Vector3d::Zero();
};

}  // namespace flextip::reproduction
