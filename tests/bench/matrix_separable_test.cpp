// Effects that a recording shows plainly, and effects that it cannot show.
#include "bench/diagnosis_matrix/separable.h"

#include <gtest/gtest.h>

#include "bench/diagnosis_matrix/truth.h"
#include "diagnosis/replay/replay.h"

namespace flextip::bench {
namespace {

using Names = std::vector<std::string>;

hidden::HiddenRecording Hidden(const Names& effects, hidden::EffectSize size, hidden::LoadKind load,
                               double duration_s = 6.0) {
  hidden::HiddenOptions options;
  options.effects = effects;
  options.size = size;
  options.scene.load = load;
  options.scene.duration_s = duration_s;
  options.links_per_side = 30;
  return hidden::MakeHidden(options, 31);
}

Separation SeparationOf(const hidden::HiddenRecording& hidden) {
  TrueModel truth(hidden.recording, hidden);
  return MeasureSeparation(truth);
}

TEST(MatrixSeparable, AYieldingTipThatCarriesNothingDoesNotShow) {
  const Separation nothing =
      SeparationOf(Hidden({"tip_compliance"}, hidden::EffectSize::kPlain, hidden::LoadKind::kNone));
  EXPECT_NEAR(nothing.value, 0.0, 1.0);
  EXPECT_EQ(nothing.rival, "none");
  EXPECT_GT(SeparationOf(
                Hidden({"tip_compliance"}, hidden::EffectSize::kStrong, hidden::LoadKind::kVarying))
                .value,
            kSeparable);
}

/// A known force that never changes moves the tip like one of the sensors' frames.
TEST(MatrixSeparable, AYieldingTipUnderAConstantForceHasRivals) {
  const Separation separation = SeparationOf(
      Hidden({"tip_compliance"}, hidden::EffectSize::kStrong, hidden::LoadKind::kHungMass));
  EXPECT_LT(separation.value, kSeparable);
  EXPECT_NE(separation.rival, "none");
}

TEST(MatrixSeparable, ALargerEffectIsFurtherFromItsRivals) {
  const Separation subtle =
      SeparationOf(Hidden({"em_latency"}, hidden::EffectSize::kSubtle, hidden::LoadKind::kNone));
  const Separation strong =
      SeparationOf(Hidden({"em_latency"}, hidden::EffectSize::kStrong, hidden::LoadKind::kNone));
  EXPECT_GT(strong.value, subtle.value);
  EXPECT_GT(strong.value, kSeparable);
}

/// Without noise, and with nothing else off, no rival can be further off than what the base
/// simulation as it stands leaves of the recording.
TEST(MatrixSeparable, IsWithinWhatTheBaseLeaves) {
  hidden::HiddenOptions options;
  options.effects = {"em_latency"};
  options.exact = options.noise_free = true;
  options.scene.load = hidden::LoadKind::kHungMass;
  options.scene.duration_s = 6.0;
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, 32);
  const diagnosis::SampleSet samples = diagnosis::MakeSampleSet(hidden.recording, "hidden");
  const diagnosis::ParameterLayout layout(samples, diagnosis::MakeCatalogue(samples));
  diagnosis::Replay base(samples, layout);
  ASSERT_TRUE(base.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  const double separation = SeparationOf(hidden).value;
  EXPECT_GT(separation, 0.0);
  EXPECT_LT(separation, base.Whiten().e.squaredNorm());
}

/// A tip that carries nothing adds nothing to the latency; one that does, does.
TEST(MatrixSeparable, APairNeedsBothOfItToShow) {
  const auto pair = [](hidden::LoadKind load) {
    return SeparationOf(
        Hidden({"tip_compliance", "em_latency"}, hidden::EffectSize::kStrong, load, 20.0));
  };
  const Separation nothing = pair(hidden::LoadKind::kNone),
                   varying = pair(hidden::LoadKind::kVarying);
  EXPECT_NEAR(nothing.value, 0.0, 1.0);
  EXPECT_EQ(nothing.rival, "em_latency");
  EXPECT_GT(varying.value, kSeparable);
}

/// Without the sensor, an effect of it is as if it were not there.
TEST(MatrixSeparable, AnEffectOfNoSensorIsNotSeparable) {
  hidden::HiddenRecording hidden =
      Hidden({"stiffness"}, hidden::EffectSize::kStrong, hidden::LoadKind::kVarying);
  hidden.recording.em0.reset();
  EXPECT_GT(SeparationOf(hidden).value, kSeparable);
  hidden.label.present = {"stiffness", "em_latency"};
  const Separation separation = SeparationOf(hidden);
  EXPECT_EQ(separation.value, 0.0);
  EXPECT_EQ(separation.rival, "stiffness");
}

TEST(MatrixTruth, IsInTheTermsOfTheReport) {
  const hidden::HiddenRecording hidden =
      Hidden({"self_weight"}, hidden::EffectSize::kPlain, hidden::LoadKind::kNone);
  EXPECT_EQ(TruthOf(hidden, "self_weight").at("mass_per_length_kg_m").at(0),
            hidden.label.parameters.at("self_weight").at("mass_per_length_kg_m").at(0) +
                hidden.recording.instrument.mass_per_length_kg_m);
  EXPECT_EQ(TruthOf(hidden, "length"), hidden.label.parameters.at("length"));
}

}  // namespace
}  // namespace flextip::bench
