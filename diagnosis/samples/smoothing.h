// Noise taken out of the replay's inputs (the wrist's path, a measured load) as far as they move
// smoothly.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace flextip::diagnosis {

struct Smoothed {
  std::vector<Eigen::Vector3d> value;
  std::vector<double> noise;  ///< what is left, standard deviation per axis
};

/// A quadratic through each sample's neighbours, as many of them (up to four on either side) as
/// agree with it within `noise`; a sample whose neighbours do not agree is left as it is.
Smoothed Smooth(const std::vector<double>& t_s, const std::vector<Eigen::Vector3d>& value,
                double noise);

}  // namespace flextip::diagnosis
