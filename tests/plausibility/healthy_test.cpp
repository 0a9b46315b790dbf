// Healthy recordings, with effects or without: nothing is to be found.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "plausibility/check_recording.h"
#include "plausibility/noise.h"
#include "recording/recording_reader.h"
#include "testdata/broken/broken_recording.h"
#include "testdata/hidden/recording.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

testing::AssertionResult FindsNothing(const Recording& recording) {
  const auto result = plausibility::CheckRecording(recording);
  if (result.findings.empty()) return testing::AssertionSuccess();
  const auto& f = result.findings.front();
  return testing::AssertionFailure() << f.id << ": " << f.text;
}

/// The seed draws motion, load, effects of all sizes, and which sensors there are.
hidden::HiddenRecording Healthy(std::uint64_t seed) {
  hidden::HiddenOptions options;
  options.scene.family = hidden::MotionFamily::kAny;
  options.scene.duration_s = 10.0;
  options.tick_rate_hz = 50.0;
  options.links_per_side = 30;
  options.drawn_effects = static_cast<int>(seed % 3);
  options.size = hidden::EffectSize(seed / 3 % 3);
  const std::vector<std::vector<std::string>> left_out{
      {}, {"em0"}, {"strain0"}, {"vision0"}, {"wrist0_orientation"}};
  options.left_out = left_out[seed % left_out.size()];
  options.with_load = seed % 7 != 4;
  if (seed % 11 == 5) options.noise_correlation = 0.9;
  if (seed % 10 == 9) options.effects = {hidden::OtherForms()[seed / 10 % 5]};
  return hidden::MakeHidden(options, seed);
}

class HealthyRecordings : public testing::TestWithParam<int> {};

TEST_P(HealthyRecordings, HaveNoFinding) {
  constexpr int kBatch = 10;
  for (int i = 0; i < kBatch; ++i) {
    const auto seed = static_cast<std::uint64_t>(3000 + kBatch * GetParam() + i);
    const hidden::HiddenRecording hidden = Healthy(seed);
    EXPECT_TRUE(FindsNothing(hidden.recording))
        << "seed " << seed << ": " << fmt::format("{}", fmt::join(hidden.label.present, ", "));
    Recording more = hidden.recording;
    broken::Rng rng(seed);
    broken::AddFurtherStreams(more, rng);
    EXPECT_TRUE(FindsNothing(more)) << "seed " << seed << " with further streams";
  }
}
INSTANTIATE_TEST_SUITE_P(Hidden, HealthyRecordings, testing::Range(0, 4));

TEST(HealthySamples, HaveNoFinding) {
  int count = 0;
  const fs::path shared = FLEXTIP_SHARED_DIR;
  for (const fs::path& folder : {fs::path(FLEXTIP_SOURCE_DIR) / "testdata/recordings",
                                 shared / "data/recordings", shared / "data"}) {
    if (!fs::exists(folder)) continue;
    for (const auto& at : fs::directory_iterator(folder)) {
      if (!fs::exists(at.path() / "recording.yaml")) continue;
      const auto read = ReadRecording(at.path(), {.check_frames = false});
      EXPECT_TRUE(FindsNothing(read.recording)) << at.path();
      ++count;
    }
  }
  EXPECT_GE(count, 7);
}

TEST(Noise, IsThatOfASmoothMotion) {
  broken::Rng rng(1);
  std::normal_distribution<double> normal;
  std::vector<double> x;
  for (int i = 0; i < 2000; ++i) x.push_back(0.05 * std::sin(0.04 * i) + 1e-4 * normal(rng));
  const auto noise = plausibility::NoiseOf({x});
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->least, 1e-4, 1e-5);
  EXPECT_NEAR(noise->most, 1e-4, 2e-5);
}

TEST(Noise, IsNotKnownOfAMotionThatIsNotResolved) {
  std::vector<double> x;
  for (int i = 0; i < 500; ++i) x.push_back(0.05 * std::sin(1.6 * i));  // 4 samples a period
  EXPECT_FALSE(plausibility::NoiseOf({x}));
}

}  // namespace
}  // namespace flextip
