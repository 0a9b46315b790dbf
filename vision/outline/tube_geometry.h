// The outline of a bent tube with a round section as a camera sees it, with its derivatives.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/camera_model.h"

namespace flextip {

/// A tube that ends at E (x along it toward the tip, E its foremost point).
struct TubeShape {
  /// A wider body on the tube, x in E (m), from < to. The outline is not used where the body may
  /// cover it.
  struct Collar {
    double from_m = 0.0, to_m = 0.0, radius_m = 0.0;
  };
  double diameter_m = 0.0;
  double length_m = 0.15;  ///< behind E; the part out of view is not used
  bool round_end = true;   ///< a half sphere within the length; else a flat disc at E
  std::optional<Collar> collar;
};

/// Returns the instrument's shaft with the body that carries its tags, their white margins
/// included. Throws InputError where a tag does not exist.
TubeShape TubeOf(const TagCollar& collar, double diameter_m, bool round_end);

/// A point of the centre line and the tangent there, toward the tip (both in E).
struct CentreLinePoint {
  Eigen::Vector3d x_E, t_E;
};
/// Returns the point of the centre line at the distance `s_m` behind E. `bend` (1/m^2) is c_y, c_z:
/// the curvature about E's axes grows as kappa = c s, as that of a shaft loaded at its tip. So
/// y = c_y s^3 / 6 at first order (the next order is kept).
CentreLinePoint TubeCentre(const Eigen::Vector2d& bend, double s_m);

/// The tube's surface at its outline.
enum class TubeRim {
  kRound,  ///< turns away from the eye: lit from there it darkens as the root of the depth inside
  kFlat,   ///< is cut off
};

enum class ContourPart { kLeft, kRight, kEnd };

/// One point of the outline. `offset` is the distance of the outline outward along `outward` (px).
/// Its derivatives are J_pose by (dw, dp) as in MovePose (px/rad, px/m) and J_bend (px m^2).
struct ContourPoint {
  Eigen::Vector2d px, outward;  ///< outward: unit, in the image
  Eigen::Matrix<double, 1, 6> J_pose;
  Eigen::RowVector2d J_bend;
  double radius_px = 0.0;  ///< the tube's, in the picture
  double place = 0.0;      ///< on its part, -1 (toward the tip) to 1
  ContourPart part = ContourPart::kEnd;
  TubeRim rim = TubeRim::kRound;
};

/// Returns `per_side` points along each side, evenly spaced in the picture over the tube's stretch
/// in view, and up to `at_end` around its end. Fewer where the collar covers them or the lens does
/// not see them. A tube seen nearly from its end has an end only.
std::vector<ContourPoint> TubeContour(const CameraModel& camera, const TubeShape& tube,
                                      const Pose& T_CE, const Eigen::Vector2d& bend, int per_side,
                                      int at_end);

}  // namespace flextip
