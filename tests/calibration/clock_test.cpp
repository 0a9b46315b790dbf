// Clocks that are off by a known offset and rate, found again; honest deviations; refusals.
#include <gmock/gmock.h>

#include "calibration/clock/align_clocks.h"
#include "calibration/verdict/clock.h"
#include "core/error.h"
#include "recording/calibrations/apply.h"
#include "tests/calibration/clock_scene.h"
#include "tests/repetitions.h"

namespace flextip {
namespace {

using testing::HasSubstr;

const StreamClock& Of(const ClockResult& result, const std::string& stream) {
  for (const StreamClock& clock : result.streams) {
    if (clock.stream == stream) return clock;
  }
  throw std::runtime_error("no " + stream);
}

/// The error of offset and rate at the origin that the result has.
Eigen::Vector2d ErrorOf(const StreamClock& clock, const TrueClock& truth) {
  const double origin_s = 1e-9 * static_cast<double>(clock.origin_ns - kClockStart_ns);
  return {clock.offset_s - (truth.offset_s + truth.rate * (origin_s - truth.origin_s)),
          clock.rate - truth.rate};
}

double Nees(const StreamClock& clock, const TrueClock& truth) {
  const Eigen::Vector2d e = ErrorOf(clock, truth);
  return e.dot(clock.covariance.inverse() * e);
}

Recording Without(Recording r, bool load_and_strain) {
  if (load_and_strain) {
    r.load0.reset();
    r.strain0.reset();
  }
  return r;
}

struct Case {
  double offset_s, rate;
};
class KnownClock : public testing::TestWithParam<Case> {};

TEST_P(KnownClock, IsFoundAgain) {
  ClockScene scene;
  scene.em = {GetParam().offset_s, GetParam().rate, 30.0};
  scene.vision = {-GetParam().offset_s, -GetParam().rate, 30.0};
  const ClockResult result = AlignClocks(Without(DrawClocks(scene, 3), true));
  EXPECT_EQ(result.reference, "wrist0");
  for (const auto& [stream, truth] :
       {std::pair{"em0", scene.em}, std::pair{"vision0", scene.vision}}) {
    const StreamClock& clock = Of(result, stream);
    ASSERT_TRUE(clock.IsUsable()) << stream << ": " << clock.reason;
    EXPECT_LT(std::sqrt(clock.covariance(0, 0)), 0.0005) << stream;
    EXPECT_LT(Nees(clock, truth), 18.0) << stream;  // of two: 1 in 8000
  }
}

INSTANTIATE_TEST_SUITE_P(Offsets, KnownClock,
                         testing::Values(Case{-9.7, 1e-4}, Case{9.8, -1e-4}, Case{0.0, 0.0},
                                         Case{0.0123, 1e-4}, Case{-3.21, 0.0}));

// 100 recordings, the EM sensor's noise white in half of them and remembered in the others.
TEST(Clocks, HaveHonestDeviations) {
  constexpr int kRecordings = Repetitions(100);
  const double sd = 1.0 / std::sqrt(kRecordings);  // of the mean, of two numbers a recording
  std::map<std::string, double> nees;
  for (int i = 0; i < kRecordings; ++i) {
    std::mt19937_64 random(500 + static_cast<std::uint64_t>(i));
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    ClockScene scene{.seconds = 40.0, .remembered = i % 2 == 0 ? 0.0 : 0.8};
    for (TrueClock* clock : {&scene.em, &scene.vision}) {
      *clock = {9.8 * unit(random), 1e-4 * unit(random), 20.0};
    }
    const ClockResult result =
        AlignClocks(Without(DrawClocks(scene, static_cast<std::uint64_t>(i)), true));
    for (const auto& [stream, truth] :
         {std::pair{"em0", scene.em}, std::pair{"vision0", scene.vision}}) {
      const StreamClock& clock = Of(result, stream);
      ASSERT_TRUE(clock.IsUsable()) << stream << " of " << i << ": " << clock.reason;
      nees[stream] += Nees(clock, truth) / 2.0 / kRecordings;
    }
  }
  for (const auto& [stream, mean] : nees) {
    RecordProperty("nees_" + stream, fmt::format("{:.3f}", mean));
    EXPECT_GT(mean, 1.0 - 3.0 * sd) << stream;
    EXPECT_LT(mean, 1.0 + 4.0 * sd) << stream;
  }
}

// Play of up to 2 mm delays the shaft by tens of milliseconds, and the port breathes by 3 mm: the
// clock is another matter.
TEST(Clocks, AreNotPlayNorBreath) {
  constexpr int kRecordings = 20;
  int honest = 0, all = 0;
  for (int i = 0; i < kRecordings; ++i) {
    std::mt19937_64 random(900 + static_cast<std::uint64_t>(i));
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    ClockScene scene{.seconds = 30.0, .em_noise_m = 1.5e-4};
    scene.play_m = 1e-3 + 1e-3 * unit(random);
    scene.breath_m = 1.5e-3 + 1.5e-3 * unit(random);
    for (TrueClock* clock : {&scene.em, &scene.vision}) {
      *clock = {2.5 * unit(random), 1e-4 * unit(random), 15.0};
    }
    const ClockResult result =
        AlignClocks(Without(DrawClocks(scene, 40 + static_cast<std::uint64_t>(i)), true));
    for (const auto& [stream, truth] :
         {std::pair{"em0", scene.em}, std::pair{"vision0", scene.vision}}) {
      const StreamClock& clock = Of(result, stream);
      ASSERT_TRUE(clock.IsUsable()) << stream << " of " << i << ": " << clock.reason;
      const double error_s = std::abs(ErrorOf(clock, truth)[0]);
      EXPECT_LT(error_s, 0.002) << stream << " of " << i;
      honest += error_s <= 2.0 * std::sqrt(clock.covariance(0, 0));
      ++all;
    }
  }
  EXPECT_GE(honest, 35) << "of " << all;  // of 40 at 95 %: 34 or fewer once in 70
}

TEST(Clocks, StrainFollowsTheLoad) {
  ClockScene scene;
  scene.strain = {4.2, 5e-5, 30.0};
  const ClockResult result = AlignClocks(DrawClocks(scene, 11), {.reference = "load0"});
  const StreamClock& clock = Of(result, "strain0");
  ASSERT_TRUE(clock.IsUsable()) << clock.reason;
  EXPECT_LT(Nees(clock, scene.strain), 18.0);
}

TEST(Clocks, ThatShareNoMotionAreRefused) {
  ClockScene elsewhere{.em_elsewhere = true};
  ClockScene still{.speed = 0.0};
  ClockScene again{.periodic = true};
  ClockScene brief{.seconds = 3.0};
  for (const ClockScene& scene : {elsewhere, still, again, brief}) {
    for (int seed = 1; seed <= Repetitions(5); ++seed) {
      const auto drawn = DrawClocks(scene, static_cast<std::uint64_t>(seed));
      const ClockResult result = AlignClocks(Without(drawn, true));
      const StreamClock& clock = Of(result, "em0");
      EXPECT_FALSE(clock.IsUsable()) << clock.offset_s;
      EXPECT_FALSE(clock.reason.empty());
    }
  }
  const Calibration entries = ClockEntries(AlignClocks(Without(DrawClocks(elsewhere, 1), true)));
  ASSERT_EQ(entries.unobservable.size(), 1u);  // vision0 is fine
  EXPECT_EQ(entries.unobservable[0].parameter, "em0.time_offset_s");
}

TEST(Clocks, NeedTwoStreams) {
  Recording r = Without(DrawClocks({}, 1), true);
  r.em0.reset();
  EXPECT_NO_THROW(AlignClocks(r));
  try {
    AlignClocks(r, {.reference = "em0"});
    FAIL() << "the reference is not there";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("em0"));
    EXPECT_THAT(error.what(), HasSubstr("wrist0, vision0"));
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("--")));
  }
  r.vision0.reset();
  EXPECT_THROW(AlignClocks(r), InputError);
}

// What is found, applied: aligned once more there is nothing left.
TEST(Clocks, AreAppliedToTheRecording) {
  ClockScene scene;
  scene.em = {6.5, -8e-5, 30.0};
  scene.vision = {-2.5, 1e-4, 30.0};
  Recording r = Without(DrawClocks(scene, 7), true);
  r.cam0.emplace();
  const Calibration found = ClockEntries(AlignClocks(r));
  EXPECT_EQ(found.covariance.rows(), 6);
  EXPECT_EQ(found.CoordinateNames().front(), "cam0.time_offset_s");
  const auto applied = ApplyCalibration("clocks.yaml", found, r);
  EXPECT_EQ(applied.used.size(), 6u);
  const ClockResult again = AlignClocks(r);
  for (const StreamClock& clock : again.streams) {
    ASSERT_TRUE(clock.IsUsable()) << clock.reason;
    EXPECT_LT(std::abs(clock.offset_s), 1e-5) << clock.stream;
    EXPECT_LT(std::abs(clock.rate), 1e-6) << clock.stream;
  }
}

TEST(Clocks, AreSaidInWords) {
  ClockScene scene{.em_elsewhere = true};
  scene.vision.offset_s = 1.25;
  const auto verdict = JudgeClocks(AlignClocks(Without(DrawClocks(scene, 2), true)));
  EXPECT_THAT(verdict.says, HasSubstr("vision0's clock is 1.25"));
  EXPECT_THAT(verdict.says, HasSubstr("behind wrist0's"));
  ASSERT_EQ(verdict.not_found.size(), 1u);
}

}  // namespace
}  // namespace flextip
