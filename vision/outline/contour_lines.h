// Scan lines across a tube's outline, and the normal equations that their edges give.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "vision/outline/contour_edge.h"
#include "vision/outline/tube_geometry.h"

namespace flextip {

/// Prior of the outline's systematic errors (standard deviations, px). Errors of neighbouring scan
/// lines go together: light from the side, a narrow shadow beside the tube, a wrong blur. So each
/// side has an offset and a slope of its own, the end an offset, a slope and a curvature, and all
/// edges a common inset. The defaults allow for a light some centimetres off the lens, whose shadow
/// moves one side by half a pixel. `LightAtLens` is for a ring light.
struct ContourErrors {
  double inset_px = 0.3;  ///< how far all edges stand inward alike: limb darkening, gamma, blur
  double side_px = 0.4, slope_px = 0.05;  ///< of each side: at its middle, and from there to an end
  double end_px = 0.3;                    ///< offset, slope and curvature along its rim
  double line_px = 0.03;                  ///< of a single line, beyond the noise

  static ContourErrors LightAtLens() { return {0.3, 0.02, 0.02, 0.05, 0.03}; }
};

struct ContourLine {
  ContourPoint point;
  std::optional<ScanEdge> edge;
  double variance_px2 = 0.0, weight = 0.0;  ///< robust weight, 0 to 1
};

/// Normal equations of the step (dw, dp) of MovePose, in units of the residuals' own standard
/// deviations. All other unknowns are eliminated.
struct ContourTerm {
  Eigen::Matrix<double, 6, 6> JtJ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> Jtr = Eigen::Matrix<double, 6, 1>::Zero();
  double chi2 = 0.0;  ///< weighted squares with the other unknowns at their best
  int points = 0;     ///< lines that count
  int lines = 0;      ///< lines looked at
  std::array<int, 3> points_of = {0, 0, 0}, lines_of = {0, 0, 0};  ///< by ContourPart
  double rms_px = 0.0;    ///< of the lines that count, after the contour's own best step
  double scale = 1.0;     ///< by which variances were multiplied to agree with the residuals
  double inset_px = 0.0;  ///< found
  /// The bend's best step is bend_step + bend_by_pose * (dw, dp).
  Eigen::Vector2d bend_step = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> bend_by_pose = Eigen::Matrix<double, 2, 6>::Zero();
};

/// The prior of the bend and of the systematic errors.
struct ContourPrior {
  Eigen::Vector2d bend_off = Eigen::Vector2d::Zero();  ///< the current bend less its mean (1/m^2)
  Eigen::Matrix2d bend_information = Eigen::Matrix2d::Zero();
  ContourErrors errors;
};

/// Looks for each line's edge within `search_px` of its point. Leaves out lines that leave the
/// picture.
std::vector<ContourLine> MeasureLines(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px);

/// Makes the equations with robust weights. The weights are Tukey's, about the contour's own best
/// step, so that a wrong pose costs no line.
ContourTerm MakeTerm(std::vector<ContourLine>& lines, const ContourPrior& prior);

}  // namespace flextip
