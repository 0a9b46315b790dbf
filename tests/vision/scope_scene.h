// Small rendered scenes for the tests of the photometric fit and the tracker.
#pragma once

#include <vector>

#include "core/camera.h"
#include "core/tag_collar.h"
#include "simulation/render/laparoscope.h"

namespace flextip {

/// 320x240 pixels of 600 px focal length, some distortion, gamma 2.2, not in R's origin.
CameraCalibration ScopeCamera();

/// A second one beside it, turned toward the same place.
CameraCalibration SecondScopeCamera();

/// Six tags of 5 mm, `behind_tip_m` to their middle; `outward_m` moves all along their normals.
TagCollar ScopeCollar(double outward_m = 0, int first_id = 0);

/// T_RE of a shaft seen by ScopeCamera from the right, its collar near the middle of the picture at
/// 0.1 m, leaning away by `lean` and rolled about its axis (at 0 one tag looks to the camera).
Pose ScopePose(double lean, double roll, const Eigen::Vector3d& offset_C = Eigen::Vector3d::Zero());

/// Tissue behind, grey.
simulation::LaparoscopeOptions ScopeOptions(const CameraCalibration& camera);

/// A slightly bent shaft that ends at T_RE.
simulation::ShaftCurve ScopeShaft(const Pose& T_RE);

/// Linear light of a frame behind a lens, blurred on a grid of a third of a pixel. (On a grid of
/// whole pixels 1.5 grey levels remain beside a Gaussian at 0.7 px.)
simulation::LinearImage LightThroughLens(const CameraCalibration& camera, const TagCollar& collar,
                                         const Pose& T_RE, double blur_px);

/// Shot and read noise as the renderer's defaults, gamma, 8 bit.
Image Film(const simulation::LinearImage& light, double gamma, unsigned seed);

/// A collar with one tag of another.
TagCollar OnlyTag(const TagCollar& collar, int id);

}  // namespace flextip
