// A shaft with a short collar before the camera, and what may hide its tags.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "simulation/render/laparoscope.h"
#include "vision/outline/tube_geometry.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {

/// ScopeShaft's diameter, with ScopeCollar upon it.
TubeShape ScopeTube();

/// A shaft that bends as one loaded at its tip (`bend` as in TubeCentre).
simulation::ShaftCurve BentScopeShaft(const Pose& T_RE, const Eigen::Vector2d& bend);

/// A metal shaft nearer to the camera that covers all tags of a collar at ScopePose and leaves the
/// tip and the shaft behind the collar free; in the frames [first, last].
simulation::Occluder CoverOfTheCollar(int first, int last);

/// The squared error of the tip's position over its covariance: 3 in the mean.
double PositionNees(const Eigen::Vector3d& p_RE, const Eigen::Matrix3d& covariance_m2,
                    const Pose& truth);
/// Of the direction, across it: 2 in the mean.
double DirectionNees(const TipPrediction& tip, const Pose& truth);

}  // namespace flextip
