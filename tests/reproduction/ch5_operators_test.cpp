// The user study's measures and statistics, and single trials.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/draw_vector.h"
#include "reproduction/chapter5/groups.h"
#include "reproduction/chapter5/statistics.h"
#include "reproduction/chapter5/study.h"
#include "reproduction/chapter5/wrist.h"

namespace flextip::reproduction {
namespace {

using Eigen::Vector3d;

TEST(Ch5Measures, StraightScrapeAtConstantDepth) {
  // 30 mm to and fro, 2 mm deep, at 30 degrees to the y axis.
  std::vector<Vector3d> tips;
  for (int i = 0; i <= 200; ++i) {
    const double s = 0.03 * (i <= 100 ? i : 200 - i) / 100;
    tips.emplace_back(0.102, s * std::cos(M_PI / 6), s * std::sin(M_PI / 6));
  }
  const Incursion got = MeasureIncursion(tips, 0.1);
  EXPECT_NEAR(got.max_depth_m, 0.002, 1e-15);
  EXPECT_EQ(got.time_part, 1.0);
  EXPECT_NEAR(got.swept_area_m2, 2 * 0.03 * 0.002, 1e-12);  // both ways count
  EXPECT_NEAR(got.outline_area_m2, 0.03 * 0.002 * (std::cos(M_PI / 6) + std::sin(M_PI / 6)), 1e-12);
}

TEST(Ch5Measures, OutsideCountsForNothing) {
  std::vector<Vector3d> tips{{0.09, 0, 0}, {0.099, 0.01, 0}, {0.103, 0.02, 0}, {0.098, 0.03, 0}};
  const Incursion got = MeasureIncursion(tips, 0.1);
  EXPECT_EQ(got.time_part, 0.25);
  EXPECT_NEAR(got.max_depth_m, 0.003, 1e-15);
  EXPECT_EQ(got.swept_area_m2, 0.0);  // no two following positions inside
  EXPECT_EQ(got.outline_area_m2, 0.0);
  EXPECT_EQ(MeasureIncursion({}, 0.1).time_part, 0.0);
}

TEST(Ch5Measures, OutlineOfANoisyPathMatchesItsEnvelope) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> tips;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d path(0.1 + 0.0005 + 0.002 * std::sin(0.013 * i), 0.02 * std::sin(0.05 * i),
                        0.02 * std::cos(0.031 * i));
    tips.emplace_back(path + 1e-4 * DrawVector<3>(normal, rng));
  }
  for (const int along : {1, 2}) {
    // The deepest path over each of 40,000 places along the wall.
    constexpr int kPlaces = 40000;
    std::vector<double> deepest(kPlaces, 0.0);
    const double width = 0.05 / kPlaces;
    for (std::size_t i = 1; i < tips.size(); ++i) {
      Eigen::Vector2d a(tips[i - 1][3 - along], tips[i - 1].x() - 0.1);
      Eigen::Vector2d b(tips[i][3 - along], tips[i].x() - 0.1);
      if (a.y() <= 0 || b.y() <= 0) continue;
      if (a.x() > b.x()) std::swap(a, b);
      const int from = static_cast<int>(std::ceil((a.x() + 0.025) / width - 0.5));
      for (int k = from; (k + 0.5) * width - 0.025 < b.x(); ++k) {
        const double part = ((k + 0.5) * width - 0.025 - a.x()) / (b.x() - a.x());
        deepest[k] = std::max(deepest[k], a.y() + part * (b.y() - a.y()));
      }
    }
    double area = 0.0;
    for (const double depth : deepest) area += depth * width;
    EXPECT_GT(area, 2e-5);
    EXPECT_NEAR(OutlineArea(tips, 0.1, along) / area, 1.0, 2e-3);
  }
}

TEST(Ch5Statistics, MeanDeviationAndTest) {
  const MeanSd of = MeanSdOf({2, 4, 4, 4, 5, 5, 7, 9});
  EXPECT_DOUBLE_EQ(of.mean, 5.0);
  EXPECT_NEAR(of.sd, std::sqrt(32.0 / 7.0), 1e-15);
  EXPECT_NEAR(of.StandardError(), of.sd / std::sqrt(8.0), 1e-15);
  // Tables of Student's t: 2.101 at 18 degrees of freedom and 5 %, 2.878 at 1 %.
  const double per_difference = std::sqrt(2.0 / 10.0);
  EXPECT_NEAR(StudentP({0, 1, 10}, {2.1009 * per_difference, 1, 10}), 0.05, 1e-5);
  EXPECT_NEAR(StudentP({2.8784 * per_difference, 1, 10}, {0, 1, 10}), 0.01, 1e-5);
  // Two degrees of freedom, closed form: p = 1 - t / sqrt(t^2 + 2).
  EXPECT_NEAR(StudentP({0, 1, 2}, {1.7, 1, 2}), 1 - 1.7 / std::sqrt(1.7 * 1.7 + 2), 1e-12);
  EXPECT_EQ(StudentP({1, 0, 10}, {1, 0, 10}), 1.0);
  EXPECT_EQ(StudentP({1, 0, 10}, {2, 0, 10}), 0.0);
}

TEST(Ch5Statistics, TheThesisUsedThisTest) {
  // 5.3: maximum depths, "p <= 0.011"; times, "p <= 0.002".
  EXPECT_NEAR(LargestP({{1, 0.5, 10}, {2, 1, 10}, {4.3, 1, 10}, {6, 0.5, 10}}), 0.011, 5e-4);
  EXPECT_NEAR(LargestP({{11, 5, 10}, {32, 10, 10}, {59, 13, 10}, {78, 10, 10}}), 0.002, 5e-4);
}

TEST(Ch5Study, OrderIsABalancedLatinSquare) {
  std::set<std::pair<int, int>> follows;
  for (int person = 0; person < 4; ++person) {
    int order[4] = {-1, -1, -1, -1};
    for (int condition = 0; condition < 4; ++condition) {
      order[PlaceInOrder(person, condition)] = condition;
    }
    for (const int condition : order) EXPECT_GE(condition, 0);
    for (int i = 1; i < 4; ++i) follows.emplace(order[i - 1], order[i]);
  }
  EXPECT_EQ(follows.size(), 12u);
  for (int condition = 0; condition < 4; ++condition) {
    std::set<int> places;
    for (int person = 0; person < 4; ++person) places.insert(PlaceInOrder(person, condition));
    EXPECT_EQ(places.size(), 4u);
  }
}

TEST(Ch5Wrist, SettlesAtItsCommandLessTheLoad) {
  ServoWrist wrist({0, 0, 0}, {0, 0, -0.2}, {.mass_kg = 0.1, .stiffness_N_m = 1000});
  const Vector3d command(0.001, 0, 0);
  double farthest = 0.0;
  for (int i = 0; i < 300; ++i) {
    wrist.Move(command, {0.3, 0, -0.2}, 1.0 / 144);
    if (i == 0) {  // critically damped: 1 - (1 + w t) exp(-w t)
      const double wt = 100.0 / 144;
      EXPECT_NEAR(wrist.Position().x(), 0.0013 * (1 - (1 + wt) * std::exp(-wt)), 3e-5);
    }
    farthest = std::max(farthest, wrist.Position().x());
  }
  EXPECT_LT((wrist.Position() - Vector3d(0.0013, 0, 0)).norm(), 1e-9);
  EXPECT_LT(farthest, 0.0013 + 1e-9);  // without overshoot
}

Trial Short(ControllerKind kind, double seconds = 8.0) {
  TrialSetup setup;
  setup.kind = kind;
  setup.seconds = seconds;
  return RunTrial(setup);
}

TEST(Ch5Trial, TheSameSeedsAreTheSameTrial) {
  const Trial a = Short(ControllerKind::kFlexTrack, 2.0),
              b = Short(ControllerKind::kFlexTrack, 2.0);
  EXPECT_EQ(a.tips, b.tips);
  EXPECT_EQ(a.recorded, b.recorded);
}

TEST(Ch5Trial, StraightCalculateGoesWhereItsGeometrySays) {
  // It holds the straight shaft's end at the wall: how deep the true tip is follows from where
  // wrist and port put that end, whatever the rod does.
  const Trial straight = Short(ControllerKind::kStraightCalculate);
  const Incursion got = MeasureIncursion(straight.tips, TrialPlaces().WallX(), false);
  ASSERT_FALSE(straight.lost);
  EXPECT_GT(got.time_part, 0.5);
  // The end is off by the flexion F, at most 20 mm + F from the axis: the arc about the port is
  // (20 mm + F)^2 / (2 x 286 mm) deep there; bending gives a part back.
  const double reach = 0.02 + straight.max_flexion_m;
  EXPECT_LT(got.max_depth_m, reach * reach / (2 * 0.286));
  EXPECT_GT(got.max_depth_m, 0.3 * reach * reach / (2 * 0.286));
  EXPECT_GT(straight.max_flexion_m, 0.01);
}

TEST(Ch5Trial, TrackingTheTipKeepsItAtTheWall) {
  for (const ControllerKind kind : {ControllerKind::kFlexTrack, ControllerKind::kRodTrack}) {
    const Trial trial = Short(kind);
    double deepest = -1.0;
    for (const auto& p : trial.tips) deepest = std::max(deepest, p.x() - TrialPlaces().WallX());
    EXPECT_LT(deepest, 0.0003) << Name(kind);
    EXPECT_GT(deepest, -0.0005) << Name(kind);  // it does get there
  }
}

TEST(Ch5Trial, OcclusionsAndLatencyAreThere) {
  TrialSetup setup;
  setup.kind = ControllerKind::kRodTrack;
  setup.sense = TipSense::kVision;
  setup.update_rate_hz = 30.0;
  setup.vision_latency_s = 0.05;
  setup.seconds = 2.0;
  EXPECT_EQ(RunTrial(setup).no_tip_part, 0.0);
  setup.seconds = 15.0;
  setup.occlusions = true;
  const Trial hidden = RunTrial(setup);
  EXPECT_GT(hidden.no_tip_part, 0.005);
  EXPECT_LT(hidden.no_tip_part, 0.25);
  EXPECT_FALSE(hidden.lost);
}

TEST(Ch5Trial, HalvingTheLinksChangesLittle) {
  // The number of links is small: what it costs is measured here against twice as many.
  TrialSetup setup;
  setup.kind = ControllerKind::kStraightCalculate;
  setup.seconds = 6.0;
  const Trial coarse = RunTrial(setup);
  setup.links = 100;
  const Trial fine = RunTrial(setup);
  ASSERT_EQ(coarse.tips.size(), fine.tips.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < fine.tips.size(); ++i) {
    worst = std::max(worst, std::abs(fine.tips[i].x() - coarse.tips[i].x()));
  }
  EXPECT_LT(worst, 3e-5);
}

TEST(Ch5Groups, NamesAreUniqueAndFound) {
  std::set<std::string> names;
  for (const auto& group : StudyGroups(true)) EXPECT_TRUE(names.insert(group.name).second);
  for (const auto& controller : CurveControllers()) {
    for (const double rate : CurveRates())
      EXPECT_TRUE(names.contains(CurveGroup(controller, rate)));
  }
}

}  // namespace
}  // namespace flextip::reproduction
