#include "simulation/plant/wrist_reading.h"

#include <cmath>
#include <numbers>

namespace flextip::simulation {

Eigen::Vector3d MeasuredWrist(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& about,
                              const Eigen::Vector3d& p_RP, const WristReading& reading) {
  const Eigen::Vector3d to_port = p_RP - p_RW;
  const double turns = to_port.norm() / reading.wavelength_m;
  const double off_m =
      reading.eccentricity_m * std::sin(2.0 * std::numbers::pi * turns + reading.phase_rad);
  return about + reading.scale * (p_RW - about) + off_m * to_port.normalized();
}

Eigen::Vector3d WristOfReading(const Eigen::Vector3d& p_measured, const Eigen::Vector3d& about,
                               const Eigen::Vector3d& p_RP, const WristReading& reading) {
  if (reading.scale == 1.0 && reading.eccentricity_m == 0.0) return p_measured;
  constexpr double kSame_m = 1e-12;
  constexpr int kIterations = 100;
  Eigen::Vector3d p_RW = p_measured;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Vector3d miss = p_measured - MeasuredWrist(p_RW, about, p_RP, reading);
    p_RW += miss / reading.scale;
    if (miss.norm() < kSame_m) break;
  }
  return p_RW;
}

}  // namespace flextip::simulation
