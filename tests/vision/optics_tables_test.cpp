// The tables of the photometric fit against the functions they stand for.
#include <gtest/gtest.h>

#include <cmath>

#include "core/derivative_check.h"
#include "tests/vision/optics_reference.h"
#include "vision/photometric/lens_map.h"
#include "vision/photometric/normal_table.h"
#include "vision/photometric/sums.h"
#include "vision/photometric/tone_curve.h"

namespace flextip {
namespace {

double Density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI); }

TEST(NormalTable, IsTheDistributionCutAtItsReach) {
  const NormalTable& table = NormalTable::Get();
  const double low = NormalCdf(-NormalTable::kReach), part = 1 - 2 * low;
  for (double x = -3.4999; x < 3.5; x += 0.00137) {
    const NormalTable::Value value = table.At(static_cast<float>(x));
    EXPECT_NEAR(value.cdf, (NormalCdf(x) - low) / part, 1e-5) << x;
    EXPECT_NEAR(value.density, Density(x) / part, 1e-5) << x;
    EXPECT_NEAR(value.cdf, NormalCdf(x), 2.5e-4) << x;  // the tails
  }
}

TEST(NormalTable, EndsAtItsReach) {
  for (const float x : {3.5f, 3.6f, 1e6f}) {
    EXPECT_EQ(NormalTable::Get().At(x).cdf, 1);
    EXPECT_EQ(NormalTable::Get().At(x).density, 0);
    EXPECT_EQ(NormalTable::Get().At(-x).cdf, 0);
    EXPECT_EQ(NormalTable::Get().At(-x).density, 0);
  }
}

// Where it is not held positive.
TEST(RobustRule, NewtonsCurvatureIsTheDerivativeOfTheWeightedResidual) {
  const RobustRule rule(2.5, Robustness::kTukeyNewton);
  for (float r = -4.5f; r < 4.6f; r += 0.13f) {
    const float step = 0.01f;
    const float rise = rule.Weight(r + step) * (r + step) - rule.Weight(r - step) * (r - step);
    EXPECT_NEAR(rule.Curvature(rule.Weight(r)), rise / (2 * step), 2e-3) << r;
  }
  for (float r = 5; r < 11.7f; r += 0.31f) {
    EXPECT_GT(rule.Curvature(rule.Weight(r)), 0) << r;
  }
  const RobustRule plain(2.5, Robustness::kTukey);
  EXPECT_EQ(plain.Curvature(plain.Weight(3)), plain.Weight(3));
}

TEST(ToneCurve, IsThePowerLaw) {
  for (const double gamma : {1.0, 1.8, 2.2, 2.4}) {
    const ToneCurve tone(gamma);
    for (double grey = 3.2; grey < 254.9; grey += 0.37) {
      const double light = std::pow(grey / 255, gamma);
      const ToneCurve::Value value = tone.At(static_cast<float>(light));
      EXPECT_NEAR(value.grey, grey, 0.02) << gamma;
      const double by_light = grey / (gamma * light);
      EXPECT_NEAR(value.by_light, by_light, (grey < 10 ? 0.1 : 0.01) * by_light)
          << gamma << " " << grey;
      const double by_gamma = -grey * std::log(light) / (gamma * gamma);
      EXPECT_NEAR(value.by_gamma, by_gamma, 0.03 + 0.002 * by_gamma) << gamma << " " << grey;
    }
  }
}

TEST(ToneCurve, DerivativesAreThoseOfItsValue) {
  for (const double gamma : {1.0, 2.2}) {
    for (const double grey : {12.0, 60.0, 128.0, 230.0}) {
      const double light = std::pow(grey / 255, gamma);
      const auto f = [](const Eigen::VectorXd& x) {
        return Eigen::VectorXd::Constant(1, ToneCurve(x[1]).At(static_cast<float>(x[0])).grey);
      };
      const ToneCurve::Value value = ToneCurve(gamma).At(static_cast<float>(light));
      const double by_light = NumericJacobian(f, Eigen::Vector2d(light, gamma), 0.05 * light)(0, 0);
      const double by_gamma = NumericJacobian(f, Eigen::Vector2d(light, gamma), 0.02)(0, 1);
      EXPECT_NEAR(value.by_light, by_light, 0.01 * by_light) << gamma << " " << grey;
      EXPECT_NEAR(value.by_gamma, by_gamma, 0.01 * by_gamma) << gamma << " " << grey;
    }
  }
}

TEST(ToneCurve, IsClippedAboveAndStraightBelow) {
  const ToneCurve tone(2.2);
  for (const float light : {1.0f, 1.3f, 1e6f}) {
    EXPECT_EQ(tone.At(light).grey, 255);
    EXPECT_EQ(tone.At(light).by_light, 0);
    EXPECT_EQ(tone.At(light).by_gamma, 0);
  }
  const auto dark = static_cast<float>(std::pow(3.0 / 255, 2.2));
  EXPECT_NEAR(tone.At(1.001f * dark).grey, tone.At(0.999f * dark).grey, 0.02);
  const ToneCurve::Value below = tone.At(-dark), further = tone.At(-2 * dark);
  EXPECT_EQ(below.by_light, further.by_light);
  EXPECT_NEAR(further.grey - below.grey, -dark * below.by_light, 1e-4);
}

TEST(ToneCurve, LightIsItsInverse) {
  for (const double gamma : {1.0, 2.2}) {
    const ToneCurve tone(gamma);
    for (const double grey : {0.0, 5.0, 77.0, 255.0}) {
      EXPECT_NEAR(tone.Light(grey), std::pow(grey / 255, gamma), 1e-12);
    }
    for (const double grey : {5.0, 77.0, 254.0}) {
      EXPECT_NEAR(tone.At(static_cast<float>(tone.Light(grey))).grey, grey, 0.02);
    }
    EXPECT_EQ(tone.Light(-4), 0);
  }
}

CameraCalibration Plain() {
  CameraCalibration c;
  c.width_px = 643;  // no multiple of the nodes' distance
  c.height_px = 365;
  c.fu_px = 475;
  c.fv_px = 470;
  c.cu_px = 323;
  c.cv_px = 177.5;
  return c;
}

TEST(LensMap, IsTheCamerasRayOnEveryLensModel) {
  const std::vector<CameraCalibration> cameras = WithEachLens(Plain());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    SCOPED_TRACE(i);
    const CameraModel camera(cameras[i]);
    const LensMap map(camera);
    ASSERT_EQ(map.WidthPx(), 643);
    ASSERT_EQ(map.HeightPx(), 365);
    double worst_px = 0;
    for (int y = 0; y < 365; y += 7) {
      for (int x = 0; x < 643; x += 3) {
        const auto ray = camera.Unproject({x, y});
        ASSERT_TRUE(ray);
        const LensMap::Ray at = map.At(x, y);
        const Eigen::Vector2d off = Eigen::Vector2d(at.x, at.y) - ray->head<2>() / ray->z();
        Eigen::Matrix<double, 2, 3> J;
        ASSERT_TRUE(camera.Project(*ray / ray->z(), &J));
        const double error_px = (J.leftCols<2>() * off).norm();
        worst_px = error_px < worst_px ? worst_px : error_px;  // keeps a NaN
      }
    }
    EXPECT_LT(worst_px, 1e-4);
  }
}

// A lens that folds over within the picture: no ray there, and none invented far beyond its rim.
TEST(LensMap, HasNoRayWhereTheLensSeesNothing) {
  const CameraModel camera(WithLens(Plain(), Distortion::kRadialTangential, {-0.9, 0, 0, 0}));
  const LensMap map(camera);
  int blind = 0, missed = 0;
  for (int y = 0; y < 365; ++y) {
    for (int x = 0; x < 643; ++x) {
      const bool seen = camera.Unproject({x, y}).has_value(),
                 mapped = std::isfinite(map.At(x, y).x);
      blind += !seen;
      missed += seen && !mapped;
      EXPECT_TRUE(seen || !mapped) << x << " " << y;
    }
  }
  EXPECT_GT(blind, 10000);
  EXPECT_LT(missed, 0.15 * 643 * 365);  // a rim two nodes wide
}

}  // namespace
}  // namespace flextip
