// The replay's residuals against their noise, and its forces.
#include "diagnosis/replay/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

/// With wrist and load as measured: smoothed ones have less noise than the covariance counts.
SampleSet WithRawInputs(const Recording& recording) {
  SampleSet samples = MakeSampleSet(recording, "small");
  for (std::size_t k = 0; k < samples.samples.size(); ++k) {
    DiagnosisSample& sample = samples.samples[k];
    const auto& wrist = recording.wrist0->samples.at(k);
    sample.p_RW = wrist.value.p_RW;
    if (samples.has_load) sample.f_tip_N = *ValueAt(recording.load0->f_tip_N, wrist.t_ns);
  }
  return samples;
}

/// Mean square of the whitened residuals of a healthy recording, nothing off.
double MeanSquare(const WhitenedRows& rows) { return rows.e.squaredNorm() / double(rows.e.size()); }

/// Bounds of five standard deviations of the mean of so many squares.
void ExpectMeanSquare(const WhitenedRows& rows, double expected) {
  const double n = double(rows.e.size());
  EXPECT_NEAR(MeanSquare(rows), expected, 5.0 * std::sqrt(2.0 / n));
}

TEST(ReplayResiduals, OfAHealthyRecordingAreTheNoise) {
  const SampleSet samples = WithRawInputs(SmallHidden(20.0, true, 42).recording);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  EXPECT_GT(replay.Whiten().e.size(), 10000);
  ExpectMeanSquare(replay.Whiten(), 1.0);
}

/// An unknown force takes three of a sample's rows for itself.
TEST(ReplayResiduals, WithAnUnknownLoadAreShortOfThreeRows) {
  const SampleSet samples = WithRawInputs(SmallHidden(20.0, false, 42).recording);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  const Eigen::VectorXd base = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(base));
  const WhitenedRows rows = replay.Whiten();
  double taken = 0.0;
  for (std::size_t k = 0; k < samples.samples.size(); ++k) taken += rows.Rows(k) > 3 ? 3.0 : 0.0;
  const double expected = 1.0 - taken / double(rows.e.size());
  EXPECT_LT(expected, 0.85);
  ExpectMeanSquare(rows, expected);
}

/// A massless shaft has the shape of force over stiffness: without gages nothing tells a softer one
/// from a load cell that reads too little, the load's noise included.
TEST(ReplayResiduals, OfASofterShaftAreThoseOfALoadThatIsReadTooSmall) {
  hidden::HiddenOptions options{.effects = {"stiffness"}, .left_out = {"strain0"}};
  options.scene.load = hidden::LoadKind::kHungMass;
  SampleSet samples = MakeSampleSet(hidden::MakeHidden(options, 42).recording, "hung");
  samples.instrument.mass_per_length_kg_m = 0.0;
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  const Eigen::VectorXd base = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(base));
  replay.FixNoiseModel();
  const auto first = [&](const char* effect) { return layout.Blocks()[layout.Find(effect)].first; };
  const int softer = first("stiffness"), too_small = first("load_scale");
  const auto rows_at = [&](int parameter) {
    Eigen::VectorXd theta = base;
    theta[parameter] = -0.2;
    EXPECT_TRUE(replay.Evaluate(theta));
    return replay.Whiten();
  };
  const WhitenedRows stiffness = rows_at(softer), load = rows_at(too_small);
  EXPECT_LT((stiffness.e - load.e).norm(), 1e-3 * stiffness.e.norm());
  for (const WhitenedRows* rows : {&stiffness, &load}) {
    const Eigen::VectorXd a = rows->X.col(softer), b = rows->X.col(too_small);
    EXPECT_LT((a - b).norm(), 1e-3 * b.norm());
  }
}

/// With gages as well: a stiffer shaft under a larger force, with gages that read too little. All
/// forces are larger by a tenth, and no sensor says so. What the columns fail to cancel is the
/// noise of the load times itself, which many recordings take for a cause.
TEST(ReplayResiduals, OfForcesThatAreAllLargerAreNone) {
  hidden::HiddenOptions options{.effects = {}};
  options.scene.load = hidden::LoadKind::kVarying;
  SampleSet samples = MakeSampleSet(hidden::MakeHidden(options, 43).recording, "varying");
  samples.instrument.mass_per_length_kg_m = 0.0;
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  replay.FixNoiseModel();
  const WhitenedRows rows = replay.Whiten();
  const auto first = [&](const char* effect) { return layout.Blocks()[layout.Find(effect)].first; };
  const Eigen::VectorXd by_load = rows.X.col(first("load_scale"));
  const Eigen::VectorXd together = by_load - rows.X.col(first("stiffness")) +
                                   rows.X.middleCols<4>(first("strain_gain")).rowwise().sum();
  EXPECT_GT(rows.X.middleCols<4>(first("strain_gain")).norm(), 0.01 * by_load.norm());
  EXPECT_LT(together.norm(), 1e-3 * by_load.norm());
}

/// Squared whitened residual of each sample.
std::vector<double> Squares(const Replay& replay) {
  const WhitenedRows rows = replay.Whiten();
  std::vector<double> squares;
  for (std::size_t k = 0; k + 1 < rows.first_row.size(); ++k)
    squares.push_back(rows.e.segment(rows.first_row[k], rows.Rows(k)).squaredNorm());
  return squares;
}

/// What is not judged at the ends has no force of its own; a camera read between its frames asks
/// for how the shape moves there all the same.
TEST(ReplayForces, OfSamplesThatAreNotJudgedDoNotSpoilThoseBeside) {
  const SampleSet samples = SmallSamples(8.0, false, 45);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(theta));
  theta[layout.Blocks()[layout.Find("camera_latency")].first] = 0.018;  // frames: 0.04 s
  ASSERT_TRUE(replay.Evaluate(theta));
  const std::vector<double> squares = Squares(replay);
  std::vector<std::size_t> judged;
  for (std::size_t k = 0; k < squares.size(); ++k)
    if (samples.samples[k].Has(row::kTipPosition)) judged.push_back(k);
  ASSERT_GT(judged.size(), 100U);
  const auto largest = [&](std::size_t from, std::size_t to) {
    double value = 0.0;
    for (std::size_t i = from; i < to; ++i) value = std::max(value, squares[judged[i]]);
    return value;
  };
  const std::size_t n = judged.size();
  EXPECT_LT(largest(0, 3), 2.0 * largest(3, 23));
  EXPECT_LT(largest(n - 3, n), 2.0 * largest(n - 23, n - 3));
}

// The EM sensor speaks late and of times between the samples: a force fitted to where the shaft was
// at the samples would follow the motion.
TEST(ReplayForces, AreFittedToWhatSensorsSayOfTheirOwnTimes) {
  hidden::HiddenOptions options{
      .effects = {"em_latency"}, .size = hidden::EffectSize::kStrong, .exact = true};
  options.with_load = false;
  options.noise_free = true;
  options.scene = {
      .motion = hidden::MotionKind::kSines, .load = hidden::LoadKind::kHungMass, .duration_s = 6.0};
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, 72);
  const SampleSet samples = MakeSampleSet(hidden.recording, "small");
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  theta[layout.Blocks()[layout.Find("em_latency")].first] =
      hidden.label.parameters.at("em_latency").at("delay_s")[0];
  const Eigen::Vector3d& hung_N = hidden.scene.load.mean_N;
  const Instrument& shaft = samples.instrument;
  for (const auto& block : layout.Blocks())
    if (block.effect->Name() == "mean_load")
      theta.segment<3>(block.first) =
          hung_N / (shaft.bending_stiffness_Nm2 / std::pow(shaft.length_m, 2));
  for (int twice = 0; twice < 2; ++twice) ASSERT_TRUE(replay.Evaluate(theta));
  const auto forces_N = replay.Forces();
  double largest_N = 0.0;
  for (std::size_t k = 20; k + 20 < forces_N.size(); ++k)
    largest_N = std::max(largest_N, (forces_N[k] - hung_N).norm());
  EXPECT_LT(largest_N / hung_N.norm(), 0.1);  // 1.8 where they were fitted to the samples' times
}

/// One sample's force far off: alone it would stay in a wrong minimum, whatever stretch it begins.
TEST(ReplayForces, AreMendedFromTheNeighbours) {
  const SampleSet samples = SmallSamples(8.0, false, 44);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  const Eigen::VectorXd base = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(base));
  const auto right_N = replay.Forces();
  auto wrong_N = right_N;
  const double unit_N = samples.instrument.bending_stiffness_Nm2 / samples.instrument.length_m /
                        samples.instrument.length_m;
  for (const std::size_t k : {64, 128, 192, 250})
    wrong_N[k] += 10.0 * unit_N * Eigen::Vector3d(0.0, 1.0, 0.5).normalized();
  replay.SetForces(wrong_N);
  ASSERT_TRUE(replay.Evaluate(base));
  for (const std::size_t k : {64, 128, 192, 250})
    EXPECT_LT((replay.Forces()[k] - right_N[k]).norm(), 0.02 * unit_N) << k;
}

/// What a known effect adds to the residuals is what its derivative says, in whitened rows too.
TEST(ReplayResiduals, AreFreeOfAnEffectThatIsSwitchedOn) {
  const hidden::HiddenRecording hidden = SmallHidden(8.0, true, 43, {"tag_offset"});
  const SampleSet samples = WithRawInputs(hidden.recording);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(theta));
  EXPECT_GT(MeanSquare(replay.Whiten()), 2.0);
  const auto& truth = hidden.label.parameters.at("tag_offset").at("offset_m");
  const int first = layout.Blocks()[layout.Find("tag_offset")].first;
  for (int i = 0; i < 3; ++i) theta[first + i] = truth[i];
  ASSERT_TRUE(replay.Evaluate(theta));
  ExpectMeanSquare(replay.Whiten(), 1.0);
}

}  // namespace
}  // namespace flextip::diagnosis
