// The rod of one sample as its sensors see it, and its derivatives.
#pragma once

#include <Eigen/Dense>

#include "diagnosis/samples/sample_set.h"
#include "kinematics/effect_rod.h"

namespace flextip::diagnosis {

/// Places of quantities in a Geometry (m, unit vectors, Nm; in R).
namespace place {
inline constexpr int kEm = 0, kEmTangent = 3, kTip = 6, kTipTangent = 9, kTipY = 12;
inline constexpr int kWristTangent = 15, kPortTangent = 18, kMoments = 21, kCount = 25;
}  // namespace place

using Geometry = Eigen::Matrix<double, place::kCount, 1>;
using GeometryByInputs = Eigen::Matrix<double, place::kCount, rod_input::kCount>;

struct SolvedSample {
  bool ok = false;
  Geometry at = Geometry::Zero();
  GeometryByInputs by_inputs = GeometryByInputs::Zero();
  double s_port_m = 0.0, ds_port_dfriction_m = 0.0;
  double lateral_force_N = 0.0;  ///< of the port
};

/// What `inputs` do to the rod; `y_wrist` in R.
RodEffects EffectsOf(const SampleInputs& inputs, const Eigen::Vector3d& y_wrist);

/// Solves one sample's rod: base, the rod's part of `inputs`, tip force.
SolvedSample SolveSample(const SampleSet& samples, std::size_t k, const SampleInputs& inputs,
                         const Eigen::Vector3d& f_tip_N, EffectRodSolver& solver);

}  // namespace flextip::diagnosis
