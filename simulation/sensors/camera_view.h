// Where a camera that is not what it was calibrated to be takes the tip to be.
#pragma once

#include "core/camera.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "simulation/sensors/effects.h"

namespace flextip::simulation {

/// The pose of E that tag tracking reports (in R, without noise) when it truly is `T_RE`. The tags
/// sit at `tag_offset_m` from where they should. The camera truly is at Exp(rotation) R_RC,
/// p_RC + translation, `T_RC` being registered. With another focal length than the calibrated one,
/// the points of a collar around the tip are projected by the true camera and their pose is solved
/// for with the calibrated one: depth comes out as Z / scale, what lies across the line of sight
/// unchanged but for terms of the collar's size over its distance. So are the points of a lens that
/// distorts more than calibrated. A camera that sinks is `t_s` after the start where it then is.
Pose SeenTip(const Pose& T_RE, const Pose& T_RC, const SensorEffects& effects, double t_s = 0.0);

/// The camera and the collar as they truly are, for rendering: hand-eye, focal length, lens, tag
/// offset. A camera that sinks is not rendered: as it was at the start.
CameraCalibration TrueCamera(const CameraCalibration& registered, const SensorEffects& effects);
TagCollar TrueCollar(const TagCollar& stated, const SensorEffects& effects);

}  // namespace flextip::simulation
