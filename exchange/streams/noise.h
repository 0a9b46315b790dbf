// The noise of a series that nobody stated.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace flextip::exchange {

struct MeasuredNoise {
  double sd = 0.0;  ///< standard deviation of one component
  std::string how;
};

/// Noise of the components by third differences: white noise stays, smooth motion goes. Where most
/// of these are zero (values of few digits), the uniform noise of rounding to the smallest step.
/// Empty for fewer than 20 values, and where they never change.
std::optional<MeasuredNoise> MeasureNoise(const std::vector<Eigen::VectorXd>& values);

/// The same of rotations, in rad about one axis.
std::optional<MeasuredNoise> MeasureNoise(std::vector<Eigen::Quaterniond> rotations);

}  // namespace flextip::exchange
