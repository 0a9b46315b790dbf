// The label's numbers in the terms the diagnosis reports in, and in those it fits.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/model/parameter_layout.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {

/// Of one effect of the catalogue, present or not. The mass per length is all of it.
simulation::EffectParameters TruthOf(const hidden::HiddenRecording& hidden,
                                     const std::string& effect);

/// The label as a point of the diagnosis's parameters.
struct TrueParameters {
  /// Of all effects, present or within tolerance; what TruthOf does not name is zero.
  Eigen::VectorXd theta;
  /// Indices of `theta` that the label does not name: the registration, the mean of an unknown
  /// force, and what effects fit beside what they are named after (a breath's overtone, where the
  /// play began, where the EM bias is zero, the turn beside a focal length).
  std::vector<int> unnamed;
};

/// Sets the layout's breathing frequency to the label's.
TrueParameters TrueTheta(const hidden::HiddenRecording& hidden, diagnosis::ParameterLayout& layout);

}  // namespace flextip::bench
