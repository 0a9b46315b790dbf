// The shaft's past, for late pictures.
#include "simulation/plant/curve_history.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flextip::simulation {
namespace {

constexpr TimeNs kStep_ns = 8'000'000;

/// A line of three points that moves along z by 1 m/s and turns about y by 1 rad/s.
ShaftCurve At(double t_s) {
  ShaftCurve curve;
  for (int i = 0; i < 3; ++i) curve.points.emplace_back(0.1 * i, 0.0, t_s);
  curve.diameter_m = 0.005;
  curve.T_RE.p = curve.points.back();
  curve.T_RE.R = Eigen::AngleAxisd(t_s, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return curve;
}

double Seconds(TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns); }

TEST(CurveHistory, GivesTheShaftOfALatencyAgo) {
  for (const double latency_s : {0.0, 0.004, 0.062, 0.25}) {
    CurveHistory history(latency_s);
    for (TimeNs t_ns = 0; t_ns < 1'000'000'000; t_ns += kStep_ns) {
      history.Add(t_ns, At(Seconds(t_ns)));
      const double then_s = std::max(0.0, Seconds(t_ns) - latency_s);
      const ShaftCurve curve = history.Before(t_ns), expected = At(then_s);
      ASSERT_EQ(curve.points.size(), 3U);
      EXPECT_LT((curve.points[1] - expected.points[1]).norm(), 1e-12) << latency_s << " " << t_ns;
      EXPECT_LT((curve.T_RE.p - expected.T_RE.p).norm(), 1e-12);
      EXPECT_LT((curve.T_RE.R - expected.T_RE.R).norm(), 1e-9);
      EXPECT_EQ(curve.diameter_m, 0.005);
    }
  }
}

TEST(CurveHistory, ReplacesACurveOfTheSameTime) {
  CurveHistory history(0.0);
  history.Add(5, At(1.0));
  history.Add(5, At(2.0));
  EXPECT_EQ(history.Before(5).points[0].z(), 2.0);
}

}  // namespace
}  // namespace flextip::simulation
