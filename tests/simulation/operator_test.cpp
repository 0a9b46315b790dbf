// Simulated operators: they cover the outline, press past the wall, tremble in their band, put
// right what they see, and differ.
#include "simulation/arm/operator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kDt_s = 1.0 / 144.0;
constexpr int kMinute = 144 * 60;

OperatorTask Task() {
  OperatorTask task;
  task.p_centre = {0.746, 0.0, 0.0};
  task.up = Vector3d(0.63, 0.0, 0.777).normalized();
  return task;
}

/// The stylus over a minute, the tip being `tip(stylus)`.
template <class Tip>
std::vector<Vector3d> Minute(SimulatedOperator& person, const Tip& tip) {
  std::vector<Vector3d> stylus;
  Vector3d p(0.73, 0.0, 0.0);
  for (int i = 0; i < kMinute; ++i) {
    p = person.Step(kDt_s, tip(p));
    stylus.push_back(p);
  }
  return stylus;
}
/// The tip follows, but not past the wall.
Vector3d Same(const Vector3d& p) { return {std::min(p.x(), 0.746), p.y(), p.z()}; }

TEST(Operator, CoversTheOutlineAndStaysInIt) {
  SimulatedOperator person(Task(), OperatorTraits(), 1);
  const auto stylus = Minute(person, Same);
  int outside = 0;
  bool covered[8][8] = {};
  double length = 0.0;
  for (std::size_t i = 144; i < stylus.size(); ++i) {
    const double y = stylus[i].y(), z = stylus[i].z();
    outside += std::hypot(y, z) > 0.022;
    const int a = static_cast<int>((y + 0.02) / 0.005), b = static_cast<int>((z + 0.02) / 0.005);
    if (a >= 0 && a < 8 && b >= 0 && b < 8) covered[a][b] = true;
    if (i % 36 == 0) length += (stylus[i] - stylus[i - 36]).tail<2>().norm();
  }
  EXPECT_LT(outside, 0.05 * kMinute);
  int cells = 0, reached = 0;
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      if (std::hypot(a - 3.5, b - 3.5) > 3.5) continue;
      ++cells;
      reached += covered[a][b];
    }
  }
  EXPECT_GT(reached, 0.9 * cells);
  EXPECT_NEAR(length / 59.0, OperatorTraits().speed_m_s, 0.3 * OperatorTraits().speed_m_s);
}

TEST(Operator, PressesPastTheWallAndWanders) {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulatedOperator person(Task(), OperatorTraits(), seed);
    const auto stylus = Minute(person, Same);
    for (std::size_t i = 288; i < stylus.size(); ++i, ++count) {
      const double depth = stylus[i].x() - 0.746;
      sum += depth;
      squares += depth * depth;
    }
  }
  const double mean = sum / count, sd = std::sqrt(squares / count - mean * mean);
  EXPECT_NEAR(mean, OperatorTraits().pressing_m, 0.0005);
  EXPECT_NEAR(sd, OperatorTraits().pressing_change_m, 0.0004);
}

TEST(Operator, TremblesInItsBand) {
  OperatorTraits still;
  still.tremor_m = 0.0;
  OperatorTraits trembling;
  trembling.tremor_hz = 9.0;
  SimulatedOperator a(Task(), still, 3), b(Task(), trembling, 3);
  const auto calm = Minute(a, Same), shaken = Minute(b, Same);
  // The same draws but for the tremor, of which the correction takes the slow part away.
  double squares = 0.0, in_band = 0.0, all = 0.0;
  std::vector<double> y;
  for (std::size_t i = 0; i < calm.size(); ++i) y.push_back(shaken[i].y() - calm[i].y());
  for (const double value : y) squares += value * value;
  for (double hz = 1.0; hz < 40.0; hz += 0.05) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
      sum += y[i] * std::polar(1.0, -2.0 * std::numbers::pi * hz * kDt_s * static_cast<double>(i));
    all += std::norm(sum);
    if (hz > 7.0 && hz < 11.0) in_band += std::norm(sum);
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(y.size())), 1.5e-4, 0.4e-4);
  // A resonance with damping 0.05 at 9 Hz has this part of its power within 2 Hz.
  EXPECT_NEAR(in_band / all, 2.0 / std::numbers::pi * std::atan(2.0 / (0.05 * 9.0)), 0.06);
}

TEST(Operator, PutsRightWhatItSeesButNotDepth) {
  OperatorTraits calm;
  calm.tremor_m = calm.pressing_change_m = 0.0;
  const Vector3d along(0.0, 0.006, -0.004);
  SimulatedOperator person(Task(), calm, 4), plain(Task(), calm, 4);
  const auto corrected = Minute(person, [&](const Vector3d& p) -> Vector3d {
    return {0.746, p.y() + along.y(), p.z() + along.z()};
  });
  const auto reference = Minute(plain, [](const Vector3d& p) -> Vector3d {
    return {0.746, p.y(), p.z()};
  });
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 3000; i < corrected.size(); ++i) {
    mean += (corrected[i] - reference[i]) / static_cast<double>(corrected.size() - 3000);
  }
  EXPECT_NEAR(mean.y(), -along.y(), 3e-4);
  EXPECT_NEAR(mean.z(), -along.z(), 3e-4);
  EXPECT_NEAR(mean.x(), 0.0, 1e-12);
  // A tip 5 mm too deep looks 5 mm x 0.63 / 0.777 too high.
  SimulatedOperator deceived(Task(), calm, 4);
  const auto low = Minute(deceived, [](const Vector3d& p) -> Vector3d {
    return {0.751, p.y(), p.z()};
  });
  double z = 0.0;
  for (std::size_t i = 3000; i < low.size(); ++i) {
    z += (low[i].z() - reference[i].z()) / static_cast<double>(low.size() - 3000);
  }
  EXPECT_NEAR(z, -0.005 * 0.63 / 0.777, 3e-4);
}

TEST(Operator, SeedsMakePeople) {
  SimulatedOperator a(Task(), DrawOperator(1), 1), again(Task(), DrawOperator(1), 1),
      other(Task(), DrawOperator(2), 1);
  const auto one = Minute(a, Same), same = Minute(again, Same), different = Minute(other, Same);
  EXPECT_EQ(one, same);
  EXPECT_NE(one, different);
  double slowest = 1.0, fastest = 0.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const OperatorTraits traits = DrawOperator(seed);
    EXPECT_GE(traits.tremor_hz, 8.0);
    EXPECT_LE(traits.tremor_hz, 12.0);
    slowest = std::min(slowest, traits.speed_m_s);
    fastest = std::max(fastest, traits.speed_m_s);
  }
  EXPECT_GT(fastest, 1.7 * slowest);
}

}  // namespace
}  // namespace flextip::simulation
