// From the rod's geometry to what each sensor says of it, with derivatives by all model inputs.
#pragma once

#include "diagnosis/geometry.h"

namespace flextip {

/// A sample's geometry and its rate of change, which latency shows.
struct TimedGeometry {
  Geometry at = Geometry::Zero();
  Geometry rate = Geometry::Zero();  ///< per second
};

/// Measured less predicted for one sample, rows without a measurement zero, and the derivative of
/// the prediction by the inputs.
struct SampleResidual {
  Rows residual = Rows::Zero();
  RowsByInputs by_inputs = RowsByInputs::Zero();
};

/// The force on the tip. `expected_N` is what other samples say of it: derivatives by the tip's
/// compliance are taken there, lest the noise of a force found from this very sample looks like
/// something explained.
struct ForceOnTip {
  Eigen::Vector3d at_N, expected_N;

  ForceOnTip(const Eigen::Vector3d& f_N) : at_N(f_N), expected_N(f_N) {}
  ForceOnTip(const Eigen::Vector3d& f_N, const Eigen::Vector3d& expected)
      : at_N(f_N), expected_N(expected) {}
};

/// `measured` is the sample with its sensors' values at the time they speak of (retiming.h).
SampleResidual Compare(const SampleSet& samples, const DiagnosisSample& measured,
                       const ModelInputs& inputs, const ForceOnTip& f_tip,
                       const TimedGeometry& geometry, const GeometryByInputs& by_inputs);

}  // namespace flextip
