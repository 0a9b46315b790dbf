// Chapter 2's maps: what comes out again, and that the statements are measured on what they say.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/linear_algebra.h"
#include "reproduction/chapter2/maps/pictures.h"
#include "reproduction/chapter2/maps/statistics.h"
#include "reproduction/chapter2/parts.h"
#include "workspace/map_figures.h"

namespace flextip::reproduction {
namespace {

const ChapterResult& Quick() {
  static const ChapterResult result = Ch2Maps({.quick = true}, [](double) {});
  return result;
}

double Value(const std::string& quantity) {
  for (const auto& row : Quick().rows)
    if (row.quantity == quantity) return row.flextip.value_or(NAN);
  ADD_FAILURE() << "no row " << quantity;
  return NAN;
}

TEST(Chapter2Maps, HasEveryFigureOfTheSection) {
  std::set<std::string> names;
  for (const auto& figure : Quick().figures) names.insert(figure.name);
  const std::set<std::string> expected{
      "fig-2-3",   "fig-2-4a",  "fig-2-4b",  "fig-2-4c",  "fig-2-5a",  "fig-2-5b",
      "fig-2-5c",  "fig-2-5d",  "fig-2-6a1", "fig-2-6a2", "fig-2-6a3", "fig-2-6a4",
      "fig-2-6b1", "fig-2-6b2", "fig-2-6b3", "fig-2-6b4", "ch2-paths"};
  EXPECT_EQ(names, expected);
}

TEST(Chapter2Maps, RowsAreNamedOnceAndHaveNumbers) {
  std::set<std::string> seen;
  for (const auto& row : Quick().rows) {
    EXPECT_TRUE(seen.insert(row.quantity).second) << row.quantity;
    EXPECT_TRUE(row.quantity.starts_with("2.") || row.quantity.starts_with("Fig. 2."))
        << row.quantity;
    ASSERT_TRUE(row.flextip) << row.quantity;
    EXPECT_TRUE(std::isfinite(*row.flextip)) << row.quantity;
  }
}

/// At N by hand: wrist at z = 95 mm, 65 mm from the true port and (75, 20) mm from the believed
/// one.
TEST(Chapter2Maps, NIsWhatItIsByHand) {
  const auto lever = [](double z_mm, double y_mm) {
    const double d = std::hypot(z_mm, y_mm);
    const Eigen::Vector2d across(-y_mm / d, z_mm / d);
    return Eigen::Matrix2d(Eigen::Matrix2d::Identity() - 320.0 / d * across * across.transpose());
  };
  const Eigen::Matrix2d G =
      Eigen::Matrix2d::Identity() - lever(65.0, 0.0) * lever(75.0, 20.0).inverse();
  EXPECT_NEAR(Value("Fig. 2.4 ||G|| at N"), SingularValues(G)[0], 1e-9);
  EXPECT_LT(Value("Fig. 2.4 ||G|| at L"), Value("Fig. 2.4 ||G|| at M"));
  EXPECT_LT(Value("Fig. 2.4 ||G|| at M"), Value("Fig. 2.4 ||G|| at N"));
}

/// On the line through both ports the Jacobians differ in the lever's ratio only.
TEST(Chapter2Maps, TheLineThroughBothPortsIsWhatItIsByHand) {
  const MapSetup<2> setup = ThesisSetup({0.010, 0.0});
  TrueShaft<2> shaft(setup.truth, setup.force);
  for (const double tip_mm : {300.0, 415.0}) {
    const auto at = MeasureAt(setup, shaft, Eigen::Vector2d(tip_mm / 1000.0, 0.0));
    const double wrist_mm = tip_mm - 320.0;
    const double ratio = (1.0 - 320.0 / (160.0 - wrist_mm)) / (1.0 - 320.0 / (170.0 - wrist_mm));
    EXPECT_NEAR(at.step.norm, std::abs(ratio - 1.0), 1e-12);
    EXPECT_NEAR(std::sin(at.angle.phi_max_rad), std::abs(ratio - 1.0) / (ratio + 1.0), 1e-12);
  }
}

TEST(Chapter2Maps, TheStatementsThatHoldHold) {
  EXPECT_GE(Value("2.3.1 least bound minus phi_max"), -1e-9);
  EXPECT_GT(Value("2.3.1 part with |phi_max| <= 90 deg"), 50.0);
  EXPECT_GT(Value("Fig. 2.6 |phi_max| at the bottom, errors in z, mean"),
            Value("Fig. 2.6 |phi_max| at the bottom, errors in y, mean"));
  EXPECT_LT(Value("Fig. 2.6 |phi_max| at the right, errors in z, mean"),
            Value("Fig. 2.6 |phi_max| at the right, errors in y, mean"));
  EXPECT_LT(Value("2.4 port error in y that keeps ||G|| < 1 from L to N"),
            Value("2.4 port error in z that keeps ||G|| < 1 from L to N"));
  EXPECT_LT(Value("2.4 largest deviation from the indirect path"),
            Value("2.4 largest deviation from the direct path"));
}

TEST(Statistics, AreThoseOfTheTextbook) {
  EXPECT_EQ(Mean({1.0, 2.0, 6.0}), 3.0);
  EXPECT_EQ(Quantile({5.0, 1.0, 3.0}, 0.5), 3.0);
  EXPECT_EQ(Quantile({5.0, 1.0, 3.0}, 1.0), 5.0);
  EXPECT_NEAR(AngleBetweenLines({1.0, 0.0}, {-1.0, 1.0}), 45.0, 1e-12);
  EXPECT_EQ(ToDigits(0.123456789), 0.12346);
  EXPECT_EQ(ToDigits(-98765.4321, 3), -98800.0);
}

}  // namespace
}  // namespace flextip::reproduction
