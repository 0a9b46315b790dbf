// The breathing frequency of hidden recordings, whose breath is no pure sine.
#include "diagnosis/search/parameter_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

constexpr double kDuration_s = 20.0;

double FoundIn(const SampleSet& samples) {
  ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  EXPECT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  const int block = layout.Find("port_motion");
  ScanAgain(replay, layout, {block}, layout.Tolerances());
  return layout.Blocks()[block].effect->ScanCentre();
}

class Breathing : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Breathing, IsFoundWithinTheResolution) {
  for (const bool with_load : {true, false}) {
    const hidden::HiddenRecording hidden =
        SmallHidden(kDuration_s, with_load, GetParam(), {"port_motion"});
    const double truth_hz = hidden.label.parameters.at("port_motion").at("frequency_hz")[0];
    EXPECT_NEAR(FoundIn(MakeSampleSet(hidden.recording, "small")), truth_hz, 0.5 / kDuration_s)
        << (with_load ? "with" : "without") << " load";
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, Breathing, testing::Values(51, 52, 53));

/// 0.31 Hz by the model itself: what a port that moves so by 1 mm would have shown.
TEST(FrequencyScan, FindsASineOf031Hz) {
  SampleSet samples = SmallSamples(kDuration_s, true, 54);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  for (std::size_t k = 0; k < samples.samples.size(); ++k) {
    DiagnosisSample& sample = samples.samples[k];
    const double wave_m = 1e-3 * std::sin(2.0 * std::numbers::pi * 0.31 * sample.t_s + 0.4);
    const auto by_port = replay.Samples()[k].compared.by_inputs.middleCols<3>(sample_input::kPort);
    const Rows moved = wave_m * (by_port * Eigen::Vector3d(0.3, 0.6, -0.7).normalized());
    sample.p_RS += moved.segment<3>(row::kEmPosition);
    sample.p_RE += moved.segment<3>(row::kTipPosition);
    sample.moments_Nm += moved.segment<4>(row::kStrain);
  }
  EXPECT_NEAR(FoundIn(samples), 0.31, 0.25 / kDuration_s);
}

}  // namespace
}  // namespace flextip::diagnosis
