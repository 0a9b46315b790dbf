// From the rod's geometry to what each sensor says of it, with derivatives by all model inputs.
#pragma once

#include "diagnosis/model/geometry.h"

namespace flextip::diagnosis {

/// A sample's geometry, its rate of change and the rate's.
struct TimedGeometry {
  Geometry at = Geometry::Zero();
  Geometry rate = Geometry::Zero();  ///< per second
  Geometry bend = Geometry::Zero();  ///< per square second

  /// `dt_s` later.
  TimedGeometry After(double dt_s) const {
    return {at + dt_s * rate + 0.5 * dt_s * dt_s * bend, rate + dt_s * bend, bend};
  }
};

/// Measured less predicted for one sample, rows without a measurement zero, and the derivative of
/// the prediction by the inputs.
struct SampleResidual {
  Rows residual = Rows::Zero();
  RowsByInputs by_inputs = RowsByInputs::Zero();
};

/// What each gage (row) reads of each moment (column).
Eigen::Matrix4d StrainBridge(const SampleInputs& inputs);

/// The force on the tip. `expected_N` is what other samples say of it: derivatives by the tip's
/// compliance are taken there, lest the noise of a force found from this very sample looks like
/// something explained.
struct ForceOnTip {
  Eigen::Vector3d at_N, expected_N;

  ForceOnTip(const Eigen::Vector3d& f_N) : at_N(f_N), expected_N(f_N) {}
  ForceOnTip(const Eigen::Vector3d& f_N, const Eigen::Vector3d& expected)
      : at_N(f_N), expected_N(expected) {}
};

/// `measured` holds what the sensors say of about the sample's time (retiming.h): each value is
/// compared with the geometry at the time that it speaks of, its stamp less its latency.
SampleResidual Compare(const SampleSet& samples, const DiagnosisSample& measured,
                       const SampleInputs& inputs, const ForceOnTip& f_tip,
                       const TimedGeometry& geometry, const GeometryByInputs& by_inputs);

}  // namespace flextip::diagnosis
