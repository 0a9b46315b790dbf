// Derivatives of what each sensor says against differences, with every effect large.
#include "diagnosis/replay/sensor_prediction.h"

#include <gtest/gtest.h>

#include <random>

#include "core/rotation.h"

namespace flextip::diagnosis {
namespace {

using namespace sample_input;

/// A geometry that is linear in the rod's inputs and in time, as Compare is told; no rod's.
class SensorDerivatives : public testing::Test {
 protected:
  SensorDerivatives() {
    samples_.has_camera = true;
    samples_.T_RC = {ExpRotation({0.3, -0.5, 0.2}), {0.35, 0.05, -0.25}};
    samples_.centre = {0.3, 0.02, -0.03};
    for (double& x : u_.head<kEmReadTurn>()) x = 0.3 * Draw();
    for (double& x : geometry_.at) x = 0.5 * Draw();
    geometry_.at.segment<3>(place::kTip) = samples_.T_RC * Eigen::Vector3d(0.06, -0.04, 0.2);
    for (double& x : geometry_.rate) x = 0.1 * Draw();
    for (double& x : by_inputs_.reshaped()) x = 0.1 * Draw();
    z_.present.set();
    for (Eigen::Vector3d* d : {&z_.d_wrist, &z_.d_port, &z_.d_em, &z_.d_tip}) {
      *d = Eigen::Vector3d(1.0, Draw(), Draw()).normalized();
    }
    for (double& x : u_.tail<kCount - kEmReadTurn>()) x = 0.3 * Draw();
  }

  double Draw() { return std::uniform_real_distribution<double>(-1.0, 1.0)(rng_); }

  /// Residuals where input `j` is larger by `h`.
  Rows ResidualsAt(int j, double h) const {
    SampleInputs u = u_;
    u[j] += h;
    TimedGeometry geometry = geometry_;
    Eigen::Vector3d f_tip_N = f_tip_N_;
    if (j < rod_input::kCount) geometry.at += h * by_inputs_.col(j);
    if (j >= kForce && j < kForce + 3) f_tip_N[j - kForce] += h;
    return Compare(samples_, z_, u, f_tip_N, geometry, by_inputs_).residual;
  }

  std::mt19937_64 rng_{5};
  SampleSet samples_;
  DiagnosisSample z_;
  SampleInputs u_;
  Eigen::Vector3d f_tip_N_{0.3, -0.5, 0.2};
  TimedGeometry geometry_;
  GeometryByInputs by_inputs_;
};

TEST_F(SensorDerivatives, OfAllInputs) {
  const RowsByInputs derivatives =
      Compare(samples_, z_, u_, f_tip_N_, geometry_, by_inputs_).by_inputs;
  for (int j = 0; j < sample_input::kCount; ++j) {
    constexpr double kStep = 1e-5;
    const Rows numeric = -(ResidualsAt(j, kStep) - ResidualsAt(j, -kStep)) / (2.0 * kStep);
    EXPECT_GT(numeric.norm(), 1e-3) << "input " << j;
    EXPECT_LT((derivatives.col(j) - numeric).norm(), 1e-8 * (1.0 + numeric.norm()))
        << "input " << j << "\n"
        << (derivatives.col(j) - numeric).transpose();
  }
}

}  // namespace
}  // namespace flextip::diagnosis
