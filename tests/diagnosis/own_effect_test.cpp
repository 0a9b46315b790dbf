// An effect of the user's own with a frequency: scanned, fitted, reported, kept in model.yaml and
// undone, with nothing of it in the library.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/error.h"
#include "diagnosis/effects/periodic.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_instrument.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

constexpr double kFrequency_hz = 1.37, kDuration_s = 20.0;
const Eigen::Vector3d kAmplitude_m(0.0012, -0.0004, 0.0006);

class ScopeShake : public PeriodicEffect {
 public:
  ScopeShake()
      : PeriodicEffect("scope_shake", "a pump shakes the scope",
                       {.first_input = sample_input::kCameraShift,
                        .tolerance = 0.00005,
                        .typical = 0.001,
                        .lowest_hz = 0.8,
                        .highest_hz = 3.0,
                        .start_hz = 1.0}) {}
  bool Applies(const SampleSet& samples) const override { return samples.has_tip; }
};

const EffectMakers kOwn{[] { return std::make_unique<ScopeShake>(); }};

/// A recording without effects, whose camera swings: the tip seems to swing the other way.
Recording Disturbed() {
  Recording recording = SmallHidden(kDuration_s, true, 71).recording;
  const TimeNs start_ns = recording.wrist0->samples.front().t_ns;
  for (auto& sample : recording.vision0->tips) {
    const double t_s = 1e-9 * static_cast<double>(sample.t_ns - start_ns);
    sample.value.p_RE -= std::sin(2 * std::numbers::pi * kFrequency_hz * t_s) * kAmplitude_m;
  }
  return recording;
}

TEST(OwnEffect, IsFoundAndKept) {
  DiagnoseOptions options;
  options.own_effects = kOwn;
  const DiagnosisResult result = Diagnose(Disturbed(), "own", options);
  ASSERT_EQ(result.verdict, Verdict{"scope_shake"});
  ASSERT_EQ(result.parameters.size(), 1U);
  const auto& parameters = result.parameters[0].parameters;
  ASSERT_EQ(parameters.size(), 3U);  // no overtone
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(parameters[0].value[i], kAmplitude_m[i], 2e-4) << i;
  EXPECT_NEAR(parameters[1].value[0], kFrequency_hz, 0.01);
  EXPECT_EQ(result.summaries.at("scope_shake"), "a pump shakes the scope");

  const auto file = std::filesystem::temp_directory_path() / "flextip_own_effect_model.yaml";
  WriteModel(file, FromResult(result));
  const ExtendedModel model = ReadModel(file, kOwn);
  ASSERT_NE(model.Find("scope_shake"), nullptr);
  EXPECT_THROW(ReadModel(file), InputError);  // the catalogue does not have it
  std::filesystem::remove(file);

  const Recording recording = Disturbed();
  EXPECT_NO_THROW(ExtendedInstrument(model, recording, kOwn));
  EXPECT_THROW(ExtendedInstrument(model, recording), InputError);
}

TEST(OwnEffect, HasANameOfItsOwn) {
  const EffectMakers twice{kOwn[0], kOwn[0]};
  EXPECT_DEATH(MakeCatalogue(SampleSet{}, {}, twice), "an own effect has a name of its own");
}

}  // namespace
}  // namespace flextip::diagnosis
