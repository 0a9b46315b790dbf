// What the vision benches put before the camera: cameras, collars, shafts, and where tags are seen.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <string>

#include "core/camera.h"
#include "core/tag_collar.h"
#include "simulation/plant/shaft_curve.h"
#include "vision/camera_model.h"
#include "vision/tags/detector.h"

namespace flextip::bench {

/// The rendered sample's camera (950 px at 1280 pixels of width, its lens and its place in R),
/// scaled to another width; 16:9.
CameraCalibration BenchCamera(int width_px, double gamma);

/// `sides` tags around the shaft, ids from `first_id`; `plate` is the side of the prism over the
/// printed pattern's (with its margin).
TagCollar RingCollar(const std::string& family, double size_m, int sides, double plate,
                     double behind_tip_m, int first_id = 0);

/// The distance of the tags' centres from the shaft's axis in such a collar.
double RingApothem_m(const std::string& family, double size_m, int sides, double plate);

/// A shaft of 0.3 m on an arc of `radius_m` that ends at T_RE.
simulation::ShaftCurve ArcShaft(const Pose& T_RE, double radius_m, double diameter_m);

/// T_CE of a shaft that points to the picture's right turned by `around` (rad, right to down) and
/// leans out of the picture by `lean` (away from the camera where positive), with E's y axis to the
/// camera but for `roll`; the collar's middle is at `middle_C`. Smooth in all of them.
Pose CollarSeen(const Eigen::Vector3d& middle_C, double around, double lean, double roll,
                double behind_tip_m);

/// Tags that face the camera by less than `max_angle_rad` with all corners in the picture, and
/// where their corners are. Other things may stand before them.
std::map<int, TagCorners> TagsInView(const CameraModel& camera, const TagCollar& collar,
                                     const Pose& T_CE, double max_angle_rad);

}  // namespace flextip::bench
