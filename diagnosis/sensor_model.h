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

/// `measured` is the sample with its sensors' values at the time they speak of (retiming.h).
SampleResidual Compare(const SampleSet& samples, const DiagnosisSample& measured,
                       const ModelInputs& inputs, const Eigen::Vector3d& f_tip_N,
                       const TimedGeometry& geometry, const GeometryByInputs& by_inputs);

}  // namespace flextip
