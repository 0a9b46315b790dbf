// The tip as a controller is given it.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "control/controller.h"
#include "estimation/measurements.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

/// Returns the tip by its own sensor (m, in R): vision's, or where `em_is_tip` that of the EM
/// sensor, carried to the tip along the sensor's axis. Empty where neither sees it.
std::optional<Eigen::Vector3d> MeasuredTip(const Measurements& measurements, bool em_is_tip);

/// Returns the tip for a controller of `kind`. The thesis's controllers take the tip as its sensor
/// gives it; rod-track as all sensors give it together, once the estimator has a fit. Empty where
/// the tip was not measured.
std::optional<Eigen::Vector3d> FuseTip(ControllerKind kind, const Measurements& measurements,
                                       const ShaftEstimate& estimate, bool em_is_tip = false);

}  // namespace flextip
