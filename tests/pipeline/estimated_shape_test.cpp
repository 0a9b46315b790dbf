// The drawn shaft against the truth of a simulated recording, whose plant shares no code with it.
#include "pipeline/estimated_shape.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/estimate_recording.h"
#include "pipeline/sensor_readings.h"
#include "testdata/hidden/recording.h"

namespace flextip {
namespace {

TEST(EstimatedShape, EndsAtTheEstimatedTipAndPassesThePort) {
  hidden::HiddenOptions options;
  options.scene.duration_s = 2.0;
  const auto hidden = hidden::MakeHidden(options, 5);
  const Recording& r = hidden.recording;
  InstrumentEstimator estimator(EstimatorOptionsFor(r.instrument, r.p_RP, r.gravity_m_s2, 3e-4));
  const auto estimates = EstimateRecording(r, estimator);
  int looked_at = 0;
  for (std::size_t i = 0; i < estimates.size(); i += 10) {
    const ShaftEstimate& e = estimates[i].value;
    const auto measured = MeasurementsAt(r, estimates[i].t_ns);
    if (!measured || e.status != EstimateStatus::kOk) continue;
    const auto shape = EstimatedShape(e, measured->p_RW, 41);
    ASSERT_EQ(shape.size(), 41U);
    ++looked_at;
    // The wrist is the measured one, not the fitted one: off by its noise.
    const double wrist_m = 5.0 * measured->wrist_position_noise_m;
    EXPECT_LT((shape.front().p_R - measured->p_RW).norm(), wrist_m + 1e-9);
    EXPECT_LT((shape.back().p_R - e.p_RE).norm(), 5.0 * wrist_m + 1e-9);
    double to_port_m = 1.0, length_m = 0.0;
    for (std::size_t k = 1; k < shape.size(); ++k) {
      const Eigen::Vector3d step = shape[k].p_R - shape[k - 1].p_R;
      length_m += step.norm();
      const double along =
          std::clamp(step.dot(e.model.p_RP - shape[k - 1].p_R) / step.squaredNorm(), 0.0, 1.0);
      to_port_m = std::min(to_port_m, (shape[k - 1].p_R + along * step - e.model.p_RP).norm());
    }
    EXPECT_NEAR(length_m, e.model.instrument.length_m, 1e-4);  // chords of the curve
    EXPECT_LT(to_port_m, 2e-4);
    const Eigen::Matrix3d off = shape.back().covariance_m2 - e.p_RE_covariance_m2;
    EXPECT_LT(off.norm(), 0.1 * e.p_RE_covariance_m2.norm());
  }
  EXPECT_GT(looked_at, 3);
}

TEST(EstimatedShape, IsEmptyWhereNothingWasFitted) {
  EXPECT_TRUE(EstimatedShape({}, Eigen::Vector3d::Zero(), 5).empty());
}

}  // namespace
}  // namespace flextip
