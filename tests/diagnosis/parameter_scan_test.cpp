// The breathing frequency of hidden recordings, whose breath is no pure sine.
#include "diagnosis/search/parameter_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "diagnosis/effects/discovered/discovered_term.h"
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

/// Adds what a port that moves by `size_m` at 0.31 Hz would have shown, by the model itself where
/// `replay` of `samples` stands.
void MovePort(const Replay& replay, double size_m, SampleSet& samples) {
  for (std::size_t k = 0; k < samples.samples.size(); ++k) {
    DiagnosisSample& sample = samples.samples[k];
    const double wave_m = size_m * std::sin(2.0 * std::numbers::pi * 0.31 * sample.t_s + 0.4);
    const auto by_port = replay.Samples()[k].compared.by_inputs.middleCols<3>(sample_input::kPort);
    const Rows moved = wave_m * (by_port * Eigen::Vector3d(0.3, 0.6, -0.7).normalized());
    sample.p_RS += moved.segment<3>(row::kEmPosition);
    sample.p_RE += moved.segment<3>(row::kTipPosition);
    sample.moments_Nm += moved.segment<4>(row::kStrain);
  }
}

TEST(FrequencyScan, FindsASineOf031Hz) {
  SampleSet samples = SmallSamples(kDuration_s, true, 54);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  MovePort(replay, 1e-3, samples);
  EXPECT_NEAR(FoundIn(samples), 0.31, 0.25 / kDuration_s);
}

// Held at zero, the jump would be all that the scan finds.
TEST(FrequencyScan, FindsASmallSineBesideAJumpOfTheWristThatIsKnown) {
  SampleSet samples = SmallSamples(kDuration_s, true, 55);
  const Eigen::Vector3d jump_m(-0.0006, -0.0023, 0.0003);
  const Term step{
      TermTarget::kWristPosition, TermShape::kStep, TermVariable::kTime, {8.9, 0.01}, jump_m, {}};
  ParameterLayout layout(samples, MakeCatalogue(samples, {}, {[&] {
                                                  return std::make_unique<DiscoveredTerm>(
                                                      step, "discovered_1");
                                                }}));
  const auto& term = layout.Blocks()[layout.Find("discovered_1")];
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(theta));
  MovePort(replay, 1e-4, samples);
  for (DiagnosisSample& sample : samples.samples)
    if (sample.t_s > 8.9) sample.p_RW += jump_m;
  theta.segment<3>(term.first) = jump_m;
  ASSERT_TRUE(replay.Evaluate(theta));
  Eigen::VectorXd prior_sd = layout.Tolerances();
  prior_sd.segment<3>(term.first).setConstant(jump_m.norm());
  const int block = layout.Find("port_motion");
  ScanAgain(replay, layout, {block}, prior_sd);
  EXPECT_NEAR(layout.Blocks()[block].effect->ScanCentre(), 0.31, 0.5 / kDuration_s);
}

}  // namespace
}  // namespace flextip::diagnosis
