// The closed loop on a plant with one effect, controlled with the base model and with the right
// one.
#include "simulation/closed_loop/gain.h"

#include <gtest/gtest.h>

#include <chrono>

#include "diagnosis/model/extended_instrument.h"
#include "simulation/closed_loop/scenario.h"
#include "tests/extended_model/model_of_label.h"

namespace flextip {
namespace {

hidden::HiddenRecording Hidden(const std::string& effect) {
  hidden::HiddenOptions options;
  options.effects = {effect};
  options.exact = true;
  options.noise_free = true;  // its noises are stated, and the loop's sensors have them
  options.scene.duration_s = 2.0;
  options.links_per_side = 30;
  return hidden::MakeHidden(options, 21);
}

struct Case {
  const char* effect;
  ControllerKind kind;
};

class KnownEffectInLoop : public testing::TestWithParam<Case> {};

/// The arm goes where it is told, so that the noise of the reading that a command starts from moves
/// the tip. That part, which the same loop without the effect has too, no model can take away. All
/// else the right model takes away.
TEST_P(KnownEffectInLoop, IsAsIfItWereNotThere) {
  const auto& [effect, kind] = GetParam();
  const hidden::HiddenRecording hidden = Hidden(effect);
  const simulation::ClosedLoopGain gain =
      simulation::MeasureClosedLoopGain(hidden.recording, ModelOfLabel(hidden));
  const simulation::ClosedLoopGain noise =
      simulation::MeasureClosedLoopGain(hidden.recording, diagnosis::ExtendedModel());
  ASSERT_EQ(gain.controllers.size(), 2u);
  ASSERT_EQ(noise.controllers.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const simulation::ControllerGain& controller = gain.controllers[i];
    ASSERT_TRUE(controller.ran);
    // What is left is the sensors' noise.
    EXPECT_LT(controller.extended.rms_m, 0.25e-3) << Name(controller.kind);
    if (controller.kind != kind) continue;
    const double noise_m = noise.controllers[i].base.rms_m;
    EXPECT_GT(controller.base.rms_m, 1.15 * noise_m);  // else nothing is shown
    EXPECT_LT(controller.extended.rms_m, 1.05 * noise_m);
    EXPECT_LT(controller.extended.max_m, controller.base.max_m);
  }
}
constexpr auto kCalculate = ControllerKind::kRodCalculate, kTrack = ControllerKind::kRodTrack;
INSTANTIATE_TEST_SUITE_P(
    , KnownEffectInLoop,
    testing::Values(Case{"stiffness", kTrack}, Case{"length", kTrack},
                    Case{"self_weight", kCalculate}, Case{"precurvature", kCalculate},
                    Case{"port_offset", kCalculate}, Case{"port_moment", kCalculate},
                    Case{"shaft_load", kCalculate}, Case{"backlash", kTrack},
                    Case{"em_distortion", kTrack}, Case{"hand_eye", kTrack},
                    Case{"focal_length", kTrack}, Case{"tag_offset", kTrack},
                    Case{"encoder_eccentricity", kCalculate}, Case{"em_interference", kTrack}),
    [](const auto& tested) { return std::string(tested.param.effect); });

/// Sensors without noise leave the first fit, which has no past, a narrow valley to go along.
TEST(ClosedLoopGain, StartsWithoutNoiseAndUnderALargeLoad) {
  simulation::Scenario scenario = simulation::ReadScenario(std::string(FLEXTIP_SOURCE_DIR) +
                                                           "/testdata/scenarios/chapter4_up.yaml");
  simulation::LoopSetup& setup = scenario.loop;
  setup.plant.effects.curvature_1_m = {0.05, 0.04};
  diagnosis::ExtendedModel model;
  model.effects = {{"precurvature", {{"curvature_1_m", {0.05, 0.04}, {}}}}};
  for (const ControllerKind kind : {kCalculate, kTrack}) {
    setup.controller.kind = kind;
    setup.model = {};
    const double without = simulation::RunClosedLoop(setup, nullptr).rms_deviation_m;
    setup.model = [&] {
      return std::make_unique<diagnosis::ExtendedInstrument>(model, setup.base);
    };
    const double with = simulation::RunClosedLoop(setup, nullptr).rms_deviation_m;
    EXPECT_LT(with, 0.2 * without) << Name(kind);
    // Where the tip is calculated, the first estimates are not at the bottom yet: 0.13 mm.
    EXPECT_LT(with, kind == kTrack ? 2e-5 : 2e-4) << Name(kind);
  }
}

TEST(ClosedLoopGain, SaysNothingOfAnInstrumentThatCannotRun) {
  hidden::HiddenRecording hidden = Hidden("stiffness");
  diagnosis::ExtendedModel model = ModelOfLabel(hidden);
  model.effects[0].parameters[0].value[0] = 1e-4;  // as soft as thread
  for (const simulation::ControllerGain& c :
       simulation::MeasureClosedLoopGain(hidden.recording, model).controllers)
    EXPECT_FALSE(c.ran);
  hidden.recording.wrist0.reset();
  EXPECT_TRUE(simulation::MeasureClosedLoopGain(hidden.recording, model).controllers.empty());
}

/// Left out of plant and controller, so the figures are those of the model without it.
TEST(ClosedLoopGain, LeavesOutWhatTheSimulationDoesNotKnow) {
  const hidden::HiddenRecording hidden = Hidden("length");
  const simulation::ClosedLoopGain without =
      simulation::MeasureClosedLoopGain(hidden.recording, ModelOfLabel(hidden));
  EXPECT_EQ(without.warning, "");
  diagnosis::ExtendedModel model = ModelOfLabel(hidden);
  model.effects.push_back({"rust", {{"depth_m", {0.1}, {}}}});
  model.within_tolerance.push_back({"moss", {{"depth_m", {0.1}, {}}}});
  const simulation::ClosedLoopGain with =
      simulation::MeasureClosedLoopGain(hidden.recording, model);
  EXPECT_NE(with.warning.find("rust, moss"), std::string::npos) << with.warning;
  ASSERT_EQ(with.controllers.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_TRUE(with.controllers[c].ran);
    EXPECT_EQ(with.controllers[c].base.rms_m, without.controllers[c].base.rms_m);
    EXPECT_EQ(with.controllers[c].extended.rms_m, without.controllers[c].extended.rms_m);
  }
}

TEST(ClosedLoopGain, IsQuickAndTheSameAgain) {
  const hidden::HiddenRecording hidden = Hidden("port_friction");
  const auto start = std::chrono::steady_clock::now();
  const simulation::ClosedLoopGain a =
      simulation::MeasureClosedLoopGain(hidden.recording, ModelOfLabel(hidden));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LT(seconds.count(), 3.0);
  const simulation::ClosedLoopGain b =
      simulation::MeasureClosedLoopGain(hidden.recording, ModelOfLabel(hidden));
  EXPECT_EQ(a.controllers[1].extended.rms_m, b.controllers[1].extended.rms_m);
}

}  // namespace
}  // namespace flextip
