// A recording that nobody made: a motion with the sensors of a real one.
#pragma once

#include <Eigen/Dense>
#include <functional>

#include "diagnosis/model/parameter_layout.h"
#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// The middle of the recorded directions from wrist to port, in R; columns: along and two across.
Eigen::Matrix3d MeanShaftFrame(const SampleSet& recorded);

/// What a motion asks for at one time.
struct ImaginedInstant {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  double roll_rad = 0.0;  ///< of the instrument about its axis
};

struct ImaginedMotion {
  double seconds = 20.0, rate_hz = 12.5;
  double load_N = 0.0;  ///< hung from the tip, and known
  std::function<ImaginedInstant(double t_s)> at;
};

/// Returns the samples of `motion`. Every sensor of `recorded` speaks in each of them; measured
/// values mean nothing.
SampleSet ImagineSamples(const SampleSet& recorded, const ImaginedMotion& motion);

/// Sets the measured values to those of the bent shaft with parameters `theta` and no force on the
/// tip, where the force is unknown: a force is then found from them. Returns false where the shaft
/// has no equilibrium in some sample.
bool MeasureByModel(SampleSet& samples, const ParameterLayout& layout,
                    const Eigen::VectorXd& theta);

}  // namespace flextip::diagnosis
