// The plan of the next motion: its course, its limits, and that it says what it takes.
#include "diagnosis/planning/next_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/planning/imagined_samples.h"
#include "diagnosis/planning/motion_file.h"
#include "diagnosis/planning/rivals.h"
#include "diagnosis/planning/tip_course.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

using Eigen::Vector3d;

const Vector3d kPort(0.3, 0.01, -0.02);
constexpr double kLength_m = 0.5;

TipCourse Triangle(double most_speed_m_s) {
  return {{{0.5, 0.0, 0.0}, {0.42, 0.08, -0.02}, {0.42, -0.05, 0.06}},
          kPort,
          kLength_m,
          most_speed_m_s};
}

TEST(TipCourse, GoesStraightAtOneSpeedAndTheWristIsNoFaster) {
  const TipCourse course = Triangle(0.08);
  double fastest = 0.0;
  constexpr double kStep_s = 1e-3;
  for (double t = 0.0; t + kStep_s < course.Seconds(); t += kStep_s) {
    const double tip = (course.Tip(t + kStep_s) - course.Tip(t)).norm() / kStep_s;
    EXPECT_LE(tip, course.Speed() * (1 + 1e-9));
    fastest = std::max(fastest, (course.Wrist(t + kStep_s) - course.Wrist(t)).norm() / kStep_s);
  }
  EXPECT_LE(fastest, 0.08 * 1.001);
  EXPECT_GT(fastest, 0.08 * 0.98);  // and no slower than need be
}

TEST(TipCourse, TheWristIsALengthFromTheTipThroughThePort) {
  const TipCourse course = Triangle(0.05);
  for (const double t : {0.0, 0.3, 1.0, 2.0}) {
    const Vector3d tip = course.Tip(t), wrist = course.Wrist(t);
    EXPECT_NEAR((tip - wrist).norm(), kLength_m, 1e-12);
    EXPECT_NEAR((tip - wrist).cross(kPort - wrist).norm(), 0.0, 1e-12);
  }
}

TEST(TipCourse, ItsPlacesUntilATimeEndThere) {
  const TipCourse course = Triangle(0.05);
  const auto places = course.PlacesUntil(0.7 * course.Seconds());
  double way = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) way += (places[i] - places[i - 1]).norm();
  EXPECT_NEAR(way, 0.7 * course.Seconds() * course.Speed(), 1e-9);
}

TEST(RecordedWorkspace, HoldsEveryPlaceOfTheWristAndNoMore) {
  const SampleSet samples = SmallSamples(6.0, true, 3);
  const Workspace space = RecordedWorkspace(samples);
  double least = 1.0, most = 0.0;
  for (const auto& sample : samples.samples) {
    const double inserted = samples.instrument.length_m - (samples.p_RP - sample.p_RW).norm();
    least = std::min(least, inserted);
    most = std::max(most, inserted);
  }
  EXPECT_DOUBLE_EQ(space.inserted_from_m, least);
  EXPECT_DOUBLE_EQ(space.inserted_to_m, most);
  EXPECT_GT(space.angle_rad, 0.05);
  EXPECT_LT(space.angle_rad, 0.6);
}

TEST(PlanNextMotion, KeepsTheLimits) {
  const MotionLimits limits{.seconds = 8.0,
                            .wrist_speed_m_s = 0.06,
                            .inserted_from_m = 0.20,
                            .inserted_to_m = 0.26,
                            .angle_rad = 0.2,
                            .may_hang_weight = false};
  const SampleSet recorded = SmallSamples(3.0, true, 5, {"tag_offset"});
  // Whatever the rivals are: this one asks for the likeliest to be made sure.
  ParameterLayout layout(recorded, MakeCatalogue(recorded));
  Replay replay(recorded, layout);
  Selection selection = Select(replay, layout);
  const NextMotion plan = PlanNextMotion(replay, selection, {{"tag_offset", "hand_eye"}}, limits);
  ASSERT_TRUE(plan.needed);
  ASSERT_GE(plan.rivals.size(), 2u);
  ASSERT_GE(plan.places_m.size(), 2u);
  EXPECT_EQ(plan.load_N, 0.0);
  EXPECT_LE(plan.seconds, 8.0);
  const TipCourse course(plan.places_m, recorded.p_RP, recorded.instrument.length_m, 0.06);
  EXPECT_LE(plan.speed_m_s, 0.06);
  const Vector3d axis = MeanShaftFrame(recorded).col(0);
  const Vector3d end =
      StraightTip(recorded.samples.back().p_RW, recorded.p_RP, recorded.instrument.length_m);
  EXPECT_NEAR((plan.places_m.front() - end).norm(), 0.0, 1e-12);  // where the recording ended
  for (std::size_t i = 1; i < plan.places_m.size(); ++i) {
    const Vector3d to_tip = plan.places_m[i] - recorded.p_RP;
    EXPECT_LE(to_tip.norm(), 0.26 + 1e-9);
    EXPECT_LE(std::acos(to_tip.normalized().dot(axis)), 0.2 + 1e-9);
  }
}

TEST(PlanNextMotion, SaysThatNothingHasToBeToldApart) {
  const auto hidden = SmallHidden(12.0, true, 7, {"stiffness"});
  const DiagnosisResult result =
      Diagnose(hidden.recording, "long",
               {.without = {}, .measure_gain = false, .plan = MotionLimits{.seconds = 5.0}});
  ASSERT_EQ(result.verdict, Verdict{"stiffness"});
  ASSERT_TRUE(result.plan);
  EXPECT_FALSE(result.plan->needed);
  EXPECT_TRUE(result.plan->places_m.empty());
}

TEST(PlanNextMotion, RefusesLimitsThatLeaveNoMotion) {
  const SampleSet recorded = SmallSamples(3.0, true, 5);
  const auto refused = [&](const MotionLimits& limits) {
    try {
      RequireUsable(limits, recorded, "it");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused({}), "");
  EXPECT_NE(refused({.inserted_from_m = 0.3, .inserted_to_m = 0.2}).find("from 0.3 to 0.2 m"),
            std::string::npos);
  EXPECT_NE(refused({.inserted_to_m = 2.0}), "");
  EXPECT_NE(refused({.inserted_from_m = -0.1}), "");
}

}  // namespace
}  // namespace flextip::diagnosis
