// Noise measured in a series against the noise that was put in.
#include "exchange/streams/noise.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"

namespace flextip::exchange {
namespace {

constexpr int kRows = 2000;

std::vector<Eigen::VectorXd> Motion(double noise_m, double step_m) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<Eigen::VectorXd> values;
  for (int i = 0; i < kRows; ++i) {
    const double t = 0.01 * i;
    Eigen::Vector3d p(0.1 * std::sin(t), 0.02 * t, 0.05 * std::cos(2 * t));
    for (double& x : p) {
      x += noise_m * normal(generator);
      if (step_m > 0) x = step_m * std::round(x / step_m);
    }
    values.emplace_back(p);
  }
  return values;
}

TEST(Noise, OfASmoothMotionIsFound) {
  for (const double noise_m : {1e-5, 1e-4, 1e-3}) {
    const auto measured = MeasureNoise(Motion(noise_m, 0.0));
    ASSERT_TRUE(measured);
    EXPECT_NEAR(measured->sd, noise_m, 0.05 * noise_m);
  }
}

TEST(Noise, OfRotationsIsFound) {
  std::mt19937 generator(6);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<Eigen::Quaterniond> rotations;
  for (int i = 0; i < kRows; ++i) {
    const Eigen::Quaterniond smooth(
        Eigen::AngleAxisd(2.0 * std::sin(0.01 * i), Eigen::Vector3d(1, 2, 3).normalized()));
    const Eigen::Vector3d w = 2e-3 * DrawVector<3>(normal, generator);
    Eigen::Quaterniond q = smooth * Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized()));
    if (i % 3 == 0) q.coeffs() = -q.coeffs();  // the same rotation
    rotations.push_back(q);
  }
  const auto measured = MeasureNoise(rotations);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->sd, 2e-3, 1e-4);
}

TEST(Noise, OfFewDigitsIsThatOfRounding) {
  std::vector<Eigen::VectorXd> values;
  for (int i = 0; i < 100; ++i) {
    values.emplace_back(Eigen::VectorXd::Constant(1, 0.01 * std::floor(0.1 * i)));
  }
  const auto measured = MeasureNoise(values);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->sd, 0.01 / std::sqrt(12.0), 1e-12);
  EXPECT_THAT(measured->how, testing::HasSubstr("rounding"));
}

TEST(Noise, OfTooFewOrEqualValuesIsNotFound) {
  auto values = Motion(1e-4, 0.0);
  values.resize(19);
  EXPECT_FALSE(MeasureNoise(values));
  EXPECT_FALSE(MeasureNoise(std::vector<Eigen::VectorXd>(50, Eigen::Vector3d(1, 2, 3))));
}

}  // namespace
}  // namespace flextip::exchange
