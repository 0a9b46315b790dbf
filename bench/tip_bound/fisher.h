// The least covariance that any unbiased estimate of the tip's pose from one frame can have.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "bench/tip_bound/scene.h"
#include "core/image.h"

namespace flextip::bench {

/// The Cramer-Rao bound of (dw, dp) as in MovePose, and of the tip's position: sqrt of the trace.
struct PoseBound {
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double TipRms() const { return std::sqrt(covariance.bottomRightCorner<3, 3>().trace()); }
};

struct TipBounds {
  /// From the pixels of the collar, and from those and the band of 7 px along the shaft's outline;
  /// all else known (light, blur, gamma, the tissue behind, the shaft's bend).
  PoseBound collar_known, all_known;
  /// The same with unknown light and dark of each tag's face, exposure, blur and gamma; with the
  /// outline, also the shaft's bend (prior of 20 / m^2).
  PoseBound collar, all;
};

/// What the film says of some pixels of a scene, and how that changes with the unknowns: the pose's
/// six first. Everything in units of each pixel's noise.
struct PixelModel {
  std::vector<int> pixels;         ///< in rows of the picture
  Eigen::MatrixXd J;               ///< a row a pixel
  Eigen::VectorXd mean, per_code;  ///< expected 8-bit value, and one over its standard deviation
  /// The bound of the pose with the other unknowns known, or not.
  PoseBound Bound(bool others_known) const;
  /// The pose's step (dw, dp) from the scene's own pose that fits `grey` best, all else known: it
  /// has the bound for its covariance if the model is right.
  Eigen::Matrix<double, 6, 1> Step(const Image& grey) const;
};

struct PixelModels {
  PixelModel collar, all;
};

/// By central differences of the noise-free picture, a quarter of a pixel either way, under the
/// film's noise: shot and read noise through gamma, and rounding to 8 bit. Clipped pixels tell
/// nothing. See Kay, Fundamentals of Statistical Signal Processing, 1993, ch. 3: the mean's part
/// of the Gaussian's information (that of the variance is left out).
PixelModels ModelPixels(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TagCollar& collar,
                        const TubeShape& tube, const BoundScene& scene);

TipBounds BoundTip(const PixelModels& models);

}  // namespace flextip::bench
