// Joints with their rates from noisy samples: a cubic fitted around each (Savitzky & Golay 1964).
#pragma once

#include "arms/data/arm_data.h"

namespace flextip::arms {

/// Half the length of the stretch that a cubic is fitted to.
inline constexpr double kSmoothing_s = 0.06;

/// Fills the joints, their speeds and accelerations, one row a row of the track.
void SmoothRates(const Track& joints, Eigen::MatrixXd& smooth, Eigen::MatrixXd& rate,
                 Eigen::MatrixXd& acceleration);

/// Returns the values averaged as SmoothRates does, so that both sides of an equation lose alike.
Eigen::MatrixXd Smoothed(const Track& track);

}  // namespace flextip::arms
