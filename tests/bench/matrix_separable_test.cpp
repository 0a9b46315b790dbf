// Effects that a recording shows plainly, and effects that it cannot show.
#include "bench/matrix_separable.h"

#include <gtest/gtest.h>

#include "bench/matrix_truth.h"
#include "diagnosis/replay.h"

namespace flextip {
namespace {

HiddenRecording Hidden(const std::string& effect, EffectSize size, LoadKind load) {
  HiddenOptions options;
  options.effects = {effect};
  options.size = size;
  options.scene.load = load;
  options.scene.duration_s = 6.0;
  options.links_per_side = 30;
  return MakeHidden(options, 31);
}

Separation SeparationOf(const HiddenRecording& hidden) {
  return MeasureSeparation(hidden.recording, hidden);
}

TEST(MatrixSeparable, AYieldingTipThatCarriesNothingDoesNotShow) {
  const Separation nothing =
      SeparationOf(Hidden("tip_compliance", EffectSize::kPlain, LoadKind::kNone));
  EXPECT_NEAR(nothing.value, 0.0, 1.0);
  EXPECT_EQ(nothing.rival, "none");
  EXPECT_GT(SeparationOf(Hidden("tip_compliance", EffectSize::kStrong, LoadKind::kVarying)).value,
            kSeparable);
}

/// A known force that never changes moves the tip like one of the sensors' frames.
TEST(MatrixSeparable, AYieldingTipUnderAConstantForceHasRivals) {
  const Separation separation =
      SeparationOf(Hidden("tip_compliance", EffectSize::kStrong, LoadKind::kHungMass));
  EXPECT_LT(separation.value, kSeparable);
  EXPECT_NE(separation.rival, "none");
}

TEST(MatrixSeparable, ALargerEffectIsFurtherFromItsRivals) {
  const Separation subtle =
      SeparationOf(Hidden("em_latency", EffectSize::kSubtle, LoadKind::kNone));
  const Separation strong =
      SeparationOf(Hidden("em_latency", EffectSize::kStrong, LoadKind::kNone));
  EXPECT_GT(strong.value, subtle.value);
  EXPECT_GT(strong.value, kSeparable);
}

/// Without noise, and with nothing else off, no rival can be further off than what the base
/// simulation as it stands leaves of the recording.
TEST(MatrixSeparable, IsWithinWhatTheBaseLeaves) {
  HiddenOptions options;
  options.effects = {"em_latency"};
  options.exact = options.noise_free = true;
  options.scene.load = LoadKind::kHungMass;
  options.scene.duration_s = 6.0;
  const HiddenRecording hidden = MakeHidden(options, 32);
  const SampleSet samples = MakeSampleSet(hidden.recording, "hidden");
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay base(samples, layout);
  ASSERT_TRUE(base.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  const double separation = MeasureSeparation(hidden.recording, hidden).value;
  EXPECT_GT(separation, 0.0);
  EXPECT_LT(separation, base.Whiten().e.squaredNorm());
}

TEST(MatrixTruth, IsInTheTermsOfTheReport) {
  const HiddenRecording hidden = Hidden("self_weight", EffectSize::kPlain, LoadKind::kNone);
  EXPECT_EQ(TruthOf(hidden, "self_weight").at("mass_per_length_kg_m").at(0),
            hidden.label.parameters.at("self_weight").at("mass_per_length_kg_m").at(0) +
                hidden.recording.instrument.mass_per_length_kg_m);
  EXPECT_EQ(TruthOf(hidden, "length"), hidden.label.parameters.at("length"));
}

}  // namespace
}  // namespace flextip
