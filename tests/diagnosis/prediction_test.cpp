// Prediction of recordings that were not fitted: the same hidden truth, another motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <ostream>
#include <utility>

#include "diagnosis/prediction/predict.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<hidden::HiddenRecording> TwoMotions(const std::string& effect, bool with_load,
                                                std::uint64_t seed) {
  hidden::HiddenOptions options{.effects = {effect}, .size = hidden::EffectSize::kPlain};
  options.with_load = with_load;
  options.scene.duration_s = 12.0;
  return hidden::MakeHiddenSeries({.options = options, .recordings = 2}, seed);
}

DiagnosisResult Fit(const hidden::HiddenRecording& hidden) {
  return Diagnose(hidden.recording, "fitted", {.measure_gain = false});
}

/// The base, for models that say nothing.
ExtendedModel Nothing(const hidden::HiddenRecording& hidden) {
  ExtendedModel model;
  model.centre_m = MakeSampleSet(hidden.recording, "hidden").centre;
  return model;
}

struct MotionCase {
  const char* effect;
  bool with_load;
};
void PrintTo(const MotionCase& motion, std::ostream* out) { *out << motion.effect; }

class AnotherMotion : public testing::TestWithParam<MotionCase> {};

/// As good as a fit to that recording itself.
TEST_P(AnotherMotion, IsPredicted) {
  const auto hidden = TwoMotions(GetParam().effect, GetParam().with_load, 17);
  const DiagnosisResult fitted = Fit(hidden[0]);
  ASSERT_THAT(fitted.verdict, ElementsAre(GetParam().effect));
  const Prediction predicted = Predict(hidden[1].recording, "other", FromResult(fitted));
  EXPECT_LT(predicted.gain.heldout_error_ratio, 0.7);
  EXPECT_LT(predicted.extended.chi2_per_dof, 0.5 * predicted.base.chi2_per_dof);
  const Prediction at_best = Predict(hidden[1].recording, "other", FromResult(Fit(hidden[1])));
  // What is left of the fit's own doubt, in parts of the base's error.
  EXPECT_LT(predicted.gain.heldout_error_ratio, at_best.gain.heldout_error_ratio + 0.03);
  EXPECT_EQ(predicted.samples, int(hidden[1].recording.wrist0->samples.size()));
}

INSTANTIATE_TEST_SUITE_P(Effects, AnotherMotion,
                         testing::Values(MotionCase{"stiffness", false},
                                         MotionCase{"em_latency", true},
                                         MotionCase{"backlash", true},
                                         MotionCase{"port_motion", true},
                                         MotionCase{"em_distortion", true}),
                         [](const auto& info) { return std::string(info.param.effect); });

TEST(Prediction, AModelOfAnotherInstrumentGainsNothing) {
  const auto ours = TwoMotions("port_offset", true, 17);
  const auto theirs = TwoMotions("stiffness", true, 18);
  const DiagnosisResult fitted = Fit(theirs[0]);
  ASSERT_THAT(fitted.verdict, ElementsAre("stiffness"));
  const Prediction predicted = Predict(ours[1].recording, "other", FromResult(fitted));
  // Chance gives a few per cent; the right model halves the error, at least.
  EXPECT_GT(predicted.gain.heldout_error_ratio, 0.9);
  EXPECT_EQ(JudgePrediction(predicted).grade, Grade::kBeware);
}

TEST(Prediction, SaysWhetherAModelHoldsGainsNothingOrMakesItWorse) {
  const auto says = [](double ratio) {
    Prediction prediction;
    prediction.gain.measured = true;
    prediction.gain.heldout_error_ratio = ratio;
    return JudgePrediction(prediction).says;
  };
  EXPECT_THAT(says(0.5), HasSubstr("The model holds"));
  EXPECT_THAT(says(1.0), HasSubstr("hardly gains"));
  EXPECT_THAT(says(10.0), HasSubstr("makes the simulation of this recording worse"));
}

TEST(Prediction, AModelThatSaysNothingIsTheBase) {
  const auto hidden = TwoMotions("port_offset", true, 17);
  const Prediction predicted = Predict(hidden[0].recording, "one", Nothing(hidden[0]));
  EXPECT_NEAR(predicted.gain.heldout_error_ratio, 1.0, 1e-9);
  EXPECT_NEAR(predicted.extended.tip_prediction_rms_m, predicted.base.tip_prediction_rms_m, 1e-9);
  EXPECT_LE(predicted.base_tip_mean_m, predicted.base.tip_prediction_rms_m);
  EXPECT_GT(predicted.base_tip_mean_m, 0.5 * predicted.base.tip_prediction_rms_m);
}

/// A frame that is registered anew each day must not count against a model.
TEST(Prediction, ARegistrationIsFoundAgain) {
  hidden::HiddenRecording hidden = SmallHidden(8.0, true, 19);
  hidden.recording.em0->registration_noise_rad = 0.02;
  hidden.recording.em0->registration_noise_m = 0.005;
  const Eigen::Vector3d shift(0.004, -0.003, 0.002);
  for (auto& sample : hidden.recording.em0->samples) sample.value.p_RS += shift;
  const Prediction predicted = Predict(hidden.recording, "shifted", Nothing(hidden));
  EXPECT_LT(predicted.base.heldout_rms.at("em0_position_m"), 4e-4);
  EXPECT_LT(predicted.extended.chi2_per_dof, 1.3);
}

/// The phase is this recording's; a model with the opposite one predicts as well.
TEST(Prediction, APhaseIsFoundAgain) {
  const hidden::HiddenRecording hidden = SmallHidden(12.0, true, 20, {"port_motion"});
  const auto& truth = hidden.label.parameters.at("port_motion");
  ExtendedModel model = Nothing(hidden);
  const double phase_rad = truth.at("phase_rad")[0];
  const auto predict = [&](double off_rad) {
    model.effects = {{"port_motion",
                      {{"amplitude_m", truth.at("amplitude_m"), {}},
                       {"frequency_hz", truth.at("frequency_hz"), {}},
                       {"phase_rad", {phase_rad + off_rad}, {}},
                       {"overtone_sine_m", {0, 0, 0}, {}},
                       {"overtone_cosine_m", {0, 0, 0}, {}}}}};
    return Predict(hidden.recording, "breath", model);
  };
  const Prediction right = predict(0.0);
  EXPECT_LT(right.gain.heldout_error_ratio, 0.3);
  for (const double off_rad : {0.7, 2.0, std::numbers::pi, -1.5})
    EXPECT_NEAR(predict(off_rad).gain.heldout_error_ratio, right.gain.heldout_error_ratio, 0.002)
        << off_rad;
}

/// What an effect within tolerance had of another recording does not act on this one.
TEST(Prediction, ADriftWithinToleranceIsAnotherRecordings) {
  const hidden::HiddenRecording hidden = SmallHidden(8.0, true, 21);
  ExtendedModel model = Nothing(hidden);
  const std::vector<double> rate_Nm_s{0.001, 0.001, 0.001, 0.001};
  model.within_tolerance = {{"strain_drift", {{"rate_Nm_s", rate_Nm_s, {}}}}};
  EXPECT_NEAR(Predict(hidden.recording, "one", model).gain.heldout_error_ratio, 1.0, 1e-9);
  model.effects = std::exchange(model.within_tolerance, {});
  EXPECT_GT(Predict(hidden.recording, "one", model).gain.heldout_error_ratio, 1.5);
}

TEST(Prediction, SaysWhatNoSensorShows) {
  hidden::HiddenRecording hidden = SmallHidden(8.0, true, 22);
  hidden.recording.em0.reset();
  ExtendedModel model = Nothing(hidden);
  model.effects = {{"em_latency", {{"delay_s", {0.05}, {}}}}};
  const Prediction predicted = Predict(hidden.recording, "no EM", model);
  EXPECT_THAT(predicted.not_shown, ElementsAre("em_latency"));
  EXPECT_NEAR(predicted.gain.heldout_error_ratio, 1.0, 1e-9);
}

}  // namespace
}  // namespace flextip::diagnosis
