// How well a camera can tell the tip by a tag collar: the least error that noise allows, and the
// error to be expected.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/camera.h"
#include "core/tag_collar.h"

namespace flextip {

/// The camera's view of a collar. Prints are as in ordinary light: white at 60 % of the sensor's
/// range, black at 5 %.
struct ViewingConditions {
  CameraCalibration camera;  ///< its lens distortion is left out; gamma unknown where absent
  double noise_grey = 2.5;   ///< standard deviation of a pixel's grey value
  double blur_px = 0.8;      ///< of the lens, Gaussian, before the pixels
  double lean_rad = 0.4363;  ///< of the shaft out of the picture's plane, the tip away: 25 degrees
};

/// RMS errors over the rolls of the collar about the shaft; a position's error is a vector's
/// length.
struct TipError {
  double tip_m = 0.0;          ///< of the tip
  double across_m = 0.0;       ///< its part across the line of sight
  double depth_m = 0.0;        ///< and along it
  double direction_rad = 0.0;  ///< of the shaft's direction
  double worst_tip_m = 0.0;    ///< of the tip at the worst roll
};

struct AccuracyAtDistance {
  double distance_m = 0.0;  ///< from the camera to the collar's middle
  double tag_px = 0.0;      ///< side of a tag that faces the camera
  double cell_px = 0.0;
  TipError least;     ///< Cramer-Rao bound: no unbiased estimate from one picture is better
  TipError expected;  ///< with what the tracker allows for print, lens and film (0.015 px a corner)
};

/// Returns the accuracy at each distance. The bound is that of the pixels of all tags in view, with
/// light, blur and (where the camera does not state it) gamma unknown; see Kay, Fundamentals of
/// Statistical Signal Processing, 1993, ch. 3. Throws InputError where a distance or a condition is
/// out of range, or where no tag is in view at some roll.
std::vector<AccuracyAtDistance> AccuracyOver(const TagCollar& collar,
                                             const ViewingConditions& conditions,
                                             const std::vector<double>& distances_m);

/// Pixels a cell that the detector needs: tags of 20 px are read, of 16 px every second
/// (docs/results/vision.md).
inline constexpr double kLeastCell_px = 2.5;

/// Returns the largest distance (m) at which a cell of a tag that faces the camera has
/// kLeastCell_px.
double ReadableTo(double cell_m, const CameraCalibration& camera);

/// Throws InputError with the way out where a tag of `cell_m` cannot be read at `distance_m`.
void CheckReadable(double tag_size_m, double cell_m, const CameraCalibration& camera,
                   double distance_m);

}  // namespace flextip
