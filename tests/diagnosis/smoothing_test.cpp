// Smoothing of the wrist's path: what it leaves, what it takes, and what it says is left.
#include "diagnosis/samples/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"

namespace flextip::diagnosis {
namespace {

constexpr double kNoise_m = 1e-4, kPeriod_s = 0.02;

/// Savitzky and Golay 1964: weight of the middle sample of a quadratic through nine, which is also
/// the variance of the smoothed value.
constexpr double kVarianceOfNine = 59.0 / 231.0;
/// Likewise of five.
constexpr double kVarianceOfFive = 17.0 / 35.0;

std::vector<double> Times(int n) {
  std::vector<double> t_s;
  for (int k = 0; k < n; ++k) t_s.push_back(k * kPeriod_s);
  return t_s;
}

Eigen::Vector3d Quadratic(double t_s) {
  return {0.3 - 0.1 * t_s, 0.02 * t_s * t_s, 0.05 + 0.04 * t_s - 0.01 * t_s * t_s};
}

TEST(Smoothing, AQuadraticStays) {
  std::vector<double> t_s = Times(60);
  for (std::size_t k = 0; k < t_s.size(); ++k) t_s[k] += 0.004 * std::sin(3.0 * double(k));
  std::vector<Eigen::Vector3d> value;
  for (const double t : t_s) value.push_back(Quadratic(t));
  const Smoothed smoothed = Smooth(t_s, value, kNoise_m);
  for (std::size_t k = 0; k < value.size(); ++k)
    EXPECT_LT((smoothed.value[k] - value[k]).norm(), 1e-12) << k;
}

TEST(Smoothing, NoiseFallsAsStated) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal(0.0, kNoise_m);
  const auto t_s = Times(6000);
  std::vector<Eigen::Vector3d> value;
  for (const double t : t_s) value.push_back(Quadratic(0.01 * t) + DrawVector<3>(normal, rng));
  const Smoothed smoothed = Smooth(t_s, value, kNoise_m);
  double squares = 0.0, standardised = 0.0;
  int nine = 0, inner = 0;
  for (std::size_t k = 4; k + 4 < value.size(); ++k, ++inner) {
    const double error2 = (smoothed.value[k] - Quadratic(0.01 * t_s[k])).squaredNorm() / 3.0;
    standardised += error2 / (smoothed.noise[k] * smoothed.noise[k]);
    const bool by_nine =
        std::abs(smoothed.noise[k] - kNoise_m * std::sqrt(kVarianceOfNine)) < 1e-9 * kNoise_m;
    if (!by_nine) continue;
    squares += error2;
    ++nine;
  }
  EXPECT_GT(nine, 0.97 * inner);  // the neighbours of noise alone agree
  EXPECT_NEAR(squares / nine / (kNoise_m * kNoise_m), kVarianceOfNine, 0.05 * kVarianceOfNine);
  EXPECT_NEAR(standardised / inner, 1.0, 0.05);
}

TEST(Smoothing, EndsHaveFewerNeighbours) {
  const auto t_s = Times(20);
  std::vector<Eigen::Vector3d> value;
  for (const double t : t_s) value.push_back(Quadratic(t));
  const Smoothed smoothed = Smooth(t_s, value, kNoise_m);
  for (const std::size_t k : {0, 1, 18, 19}) EXPECT_EQ(smoothed.noise[k], kNoise_m) << k;
  for (const std::size_t k : {2, 17})
    EXPECT_NEAR(smoothed.noise[k], kNoise_m * std::sqrt(kVarianceOfFive), 1e-12) << k;
}

TEST(Smoothing, AKinkIsNotSmoothedAway) {
  const auto t_s = Times(80);
  const double turn_s = t_s[40];
  std::vector<Eigen::Vector3d> value;
  for (const double t : t_s) value.push_back({0.1 * std::abs(t - turn_s), 0.0, 0.0});
  const Smoothed smoothed = Smooth(t_s, value, kNoise_m);
  for (std::size_t k = 0; k < value.size(); ++k)
    EXPECT_LT((smoothed.value[k] - value[k]).norm(), 1e-12) << k;
  EXPECT_EQ(smoothed.noise[40], kNoise_m);
  EXPECT_LT(smoothed.noise[20], 0.6 * kNoise_m);
}

TEST(Smoothing, NothingIsDoneToExactValues) {
  const std::vector<Eigen::Vector3d> value(12, Eigen::Vector3d(0.1, 0.2, 0.3));
  const Smoothed smoothed = Smooth(Times(12), value, 0.0);
  EXPECT_EQ(smoothed.value, value);
  for (const double noise : smoothed.noise) EXPECT_EQ(noise, 0.0);
}

}  // namespace
}  // namespace flextip::diagnosis
