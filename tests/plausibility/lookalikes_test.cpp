// Recordings that look as if something else were wrong with them than is.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "plausibility/check_recording.h"
#include "plausibility/timing/lag.h"
#include "testdata/broken/broken_recording.h"
#include "testdata/hidden/recording.h"
#include "tests/plausibility/all_streams.h"

namespace flextip {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kSecond_ns = 1e9;

/// A healthy recording with all streams.
Recording Healthy(std::uint64_t seed, hidden::MotionKind motion = hidden::MotionKind::kSines) {
  hidden::SceneDraw scene;
  scene.motion = motion;
  scene.load = hidden::LoadKind::kVarying;
  return WithAllStreams(scene, seed);
}

std::vector<std::string> Found(const Recording& recording) {
  std::vector<std::string> ids;
  for (const auto& f : plausibility::CheckRecording(recording).findings) ids.push_back(f.id);
  return ids;
}

/// sin(2 pi t / 4 s) + a tenth of another motion, late by 0.5 s.
TEST(Lags, OfAMotionThatRepeatsAreSeveral) {
  const auto at = [](double late_s) -> plausibility::VectorAt {
    return [late_s](TimeNs t_ns) -> std::optional<Vector3d> {
      const double t = static_cast<double>(t_ns) / kSecond_ns - late_s;
      if (t < -1.0 || t > 41.0) return {};
      return Vector3d(std::sin(1.5707963 * t), 0.1 * std::sin(0.31 * t * t / 10.0), 0.0);
    };
  };
  const auto lags = plausibility::FindLags(at(0.0), at(0.5), {0, 40'000'000'000, 0.0, 20.0});
  ASSERT_GE(lags.size(), 3U);
  EXPECT_NEAR(lags[0].seconds, 0.5, 0.021);
  std::vector<double> seconds;
  for (const auto& lag : lags) seconds.push_back(lag.seconds);
  EXPECT_THAT(seconds, testing::Contains(testing::DoubleNear(4.5, 0.1)));
  EXPECT_THAT(seconds, testing::Contains(testing::DoubleNear(-3.5, 0.1)));
}

/// Every pass of a raster is like the one before.
TEST(Lookalikes, AMotionThatRepeatsIsNoClock) {
  for (const std::uint64_t seed : {5001U, 5002U, 5003U}) {
    for (const auto motion : {hidden::MotionKind::kRaster, hidden::MotionKind::kStar})
      EXPECT_THAT(Found(Healthy(seed, motion)), IsEmpty()) << seed << " " << Name(motion);
  }
}

TEST(Lookalikes, MomentsInNmmAreNoStiffness) {
  Recording recording = Healthy(5010);
  recording.load0.reset();
  for (auto& s : recording.strain0->moments_Nm) s.value *= 1e3;
  EXPECT_THAT(Found(recording), ElementsAre("strain0.unit"));
}

/// A controller that listens to noise commands it: the wrist trembles as it is told.
TEST(Lookalikes, ATremblingCommandIsNoNoise) {
  Recording recording = Healthy(5020);
  broken::Rng rng(1);
  std::normal_distribution<double> normal;
  auto& wrist = recording.wrist0->samples;
  auto& command = recording.command0->p_RW;
  const double sd = 10.0 * recording.wrist0->position_noise_m;
  for (std::size_t i = 0; i + 1 < command.size(); ++i) {
    const Vector3d tremble = sd * DrawVector<3>(normal, rng);
    command[i].value += tremble;
    wrist[i + 1].value.p_RW += tremble;
  }
  EXPECT_THAT(Found(recording), IsEmpty());
  recording.command0 = Healthy(5020).command0;  // that nobody told it to
  EXPECT_THAT(Found(recording), ElementsAre("wrist0.noise"));
}

/// What to write for a noise that is not there would be taken for a noise.
TEST(Lookalikes, ReadingsThatNeverChangeHaveNoNoiseToWrite) {
  Recording recording = Healthy(5025);
  const auto stand = [](auto& series) {
    for (auto& sample : series) sample.value = series.front().value;
  };
  stand(recording.wrist0->samples);
  stand(recording.command0->p_RW);
  stand(recording.em0->samples);
  stand(recording.em1->samples);
  stand(recording.strain0->moments_Nm);
  stand(recording.load0->f_tip_N);
  stand(recording.vision0->tips);
  const auto findings = plausibility::CheckRecording(recording).findings;
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [](const auto& f) { return f.id == "em0.noise"; });
  ASSERT_NE(found, findings.end());
  EXPECT_THAT(found->text, testing::HasSubstr("never change"));
  EXPECT_THAT(found->mend, testing::Not(testing::HasSubstr("noise_m:")));
}

/// A sensor of 100 Hz that a loop of 120 Hz reads: steps of one or two ticks, the mean as stated.
TEST(Lookalikes, UnevenStepsOfTheRightMeanAreNoRate) {
  Recording recording = Healthy(5030);
  auto& samples = recording.em0->samples;
  const TimeNs begin = samples.front().t_ns;
  const double rate_hz = recording.em0->rate_hz, tick_s = 1.0 / (1.2 * rate_hz);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double due_s = static_cast<double>(i) / rate_hz;
    samples[i].t_ns =
        begin + static_cast<TimeNs>(std::llround(std::ceil(due_s / tick_s - 1e-6) * tick_s * 1e9));
  }
  EXPECT_THAT(Found(recording), IsEmpty());
  recording.em0->rate_hz *= 1.4;
  EXPECT_THAT(Found(recording), ElementsAre("em0.rate"));
}

/// A straight line over a gap is no motion, and nothing is wrong with the rest.
TEST(Lookalikes, AGapOnACircleIsAGap) {
  Recording recording = Healthy(5040, hidden::MotionKind::kCircle);
  auto& samples = recording.em0->samples;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  samples.erase(samples.begin() + 4 * n / 10, samples.begin() + 6 * n / 10);
  EXPECT_THAT(Found(recording), ElementsAre("em0.gap"));
}

/// A sensor with noise never reads the same twice, wherever it is.
TEST(Lookalikes, ANoisySensorThatStandsStillIsFrozenAtRest) {
  Recording recording = Healthy(5050);
  auto& samples = recording.em0->samples;
  for (std::size_t i = 300; i < 330; ++i) samples[i].value = samples[300].value;
  EXPECT_THAT(Found(recording), ElementsAre("em0.frozen"));
}

/// Moments that a load with the other sign makes lie at no other time.
TEST(Lookalikes, ASignIsNoClock) {
  Recording recording = Healthy(5060);
  for (auto& s : recording.load0->f_tip_N) s.value = -s.value;
  EXPECT_THAT(Found(recording), ElementsAre("load0.sign"));
}

/// Orientations in another form do not shift the gages' clock.
TEST(Lookalikes, AnOrientationIsNoClockOfForces) {
  Recording recording = Healthy(5070);
  recording.vision0.reset();
  for (auto& s : recording.em0->samples) {
    const auto q = s.value.q_RS;
    s.value.q_RS = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w());
  }
  EXPECT_THAT(Found(recording), ElementsAre("em0.quaternion_order"));
}

/// Where all others are off by the same, it is the wrist.
TEST(Lookalikes, AllClocksOffAlikeAreTheWrists) {
  for (const double shift_s : {-2.7, 1.3, 9.0}) {
    Recording recording = Healthy(5080, hidden::MotionKind::kRaster);
    for (auto& s : recording.wrist0->samples)
      s.t_ns += static_cast<TimeNs>(std::llround(shift_s * kSecond_ns));
    EXPECT_THAT(Found(recording), ElementsAre("wrist0.clock")) << shift_s;
  }
}

}  // namespace
}  // namespace flextip
