// Where the wrist truly is when its encoders say that it is somewhere.
#pragma once

#include <Eigen/Dense>

#include "simulation/plant/effects.h"

namespace flextip::simulation {

/// Returns what the encoders say of a wrist that truly is at `p_RW`: by the gear ratio, about
/// `about`, then by the pulley, along the line to the registered port `p_RP`.
Eigen::Vector3d MeasuredWrist(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& about,
                              const Eigen::Vector3d& p_RP, const WristReading& reading);

/// Returns the true place whose reading is `p_measured`, by iteration. The pulley's wave must be
/// long: 2 pi eccentricity below the wavelength.
Eigen::Vector3d WristOfReading(const Eigen::Vector3d& p_measured, const Eigen::Vector3d& about,
                               const Eigen::Vector3d& p_RP, const WristReading& reading);

}  // namespace flextip::simulation
