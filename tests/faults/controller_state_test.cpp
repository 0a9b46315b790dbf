// A controller that is given another's state goes on as it would, bit for bit.
#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/error.h"
#include "diagnosis/model/extended_model.h"
#include "simulation/closed_loop/closed_loop.h"
#include "simulation/closed_loop/loop_table.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip::simulation {
namespace {

struct Case {
  const char* name;
  const char* scenario = "press";
  ControllerKind kind = ControllerKind::kRodTrack;
  double latency_s = 0.0;
  bool model = false;
  int window_samples = 0;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

Scenario ScenarioOf(const Case& c) {
  Scenario scenario =
      ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/" + c.scenario + ".yaml");
  LoopSetup& loop = scenario.loop;
  loop.plant_options = {30, 30};
  loop.controller.kind = c.kind;
  loop.supervision.kind = SupervisionKind::kFull;
  loop.supervision.rate_hz = loop.update_rate_hz;
  loop.faults = {{FaultKind::kSpikes, FaultStream::kTip, 0.3, 0.3, 0.01}};
  loop.max_s = 1.2;
  loop.tip_latency.value_s = c.latency_s;
  loop.sensor_effects.camera_latency_s = c.latency_s;
  if (c.model) {
    diagnosis::ExtendedModel model;
    model.start_ns = 1'700'000'000'000'000'000;
    model.effects.push_back(
        {"backlash", {{"width_m", {0.001}, {}}, {"start_m", {0.0, 0.0, 0.0}, {}}}});
    model.effects.push_back({"port_friction", {{"coefficient", {0.2}, {}}}});
    UseModel(model, scenario);
  }
  return scenario;
}

class GivenState : public testing::TestWithParam<Case> {};

TEST_P(GivenState, GoesOnBitForBit) {
  Scenario scenario = ScenarioOf(GetParam());
  LoopSetup& loop = scenario.loop;
  std::vector<LoopCycle> cycles;
  loop.note_cycle = [&](const LoopCycle& cycle) { cycles.push_back(cycle); };
  RunClosedLoop(loop, nullptr);
  ASSERT_GT(cycles.size(), 20U);
  InstrumentControllerOptions options = ControllerOptionsOf(loop);
  options.window_samples = GetParam().window_samples;
  const auto make = [&] {
    return std::make_unique<InstrumentController>(options, loop.model ? loop.model() : nullptr);
  };
  const auto first = make();
  std::vector<std::pair<std::unique_ptr<InstrumentController>, std::size_t>> later;
  for (std::size_t k = 0; k < cycles.size(); ++k) {
    if (k == 0 || k == 5 || k == cycles.size() / 2) {
      StateText out;
      first->VisitState(out);
      StateText in(out.Text());
      later.emplace_back(make(), k);
      later.back().first->VisitState(in);
      in.Finish();
    }
    LoopCycle expected = cycles[k];
    TakeCommand(first->Step(InputsOf(cycles[k])), expected);
    for (auto& [controller, from] : later) {
      LoopCycle again = cycles[k];
      TakeCommand(controller->Step(InputsOf(cycles[k])), again);
      ASSERT_TRUE(SameCommand(expected, again)) << "cycle " << k << ", state of " << from;
    }
    if (GetParam().window_samples == 0) {
      ASSERT_TRUE(SameCommand(expected, cycles[k])) << "cycle " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    , GivenState,
    testing::Values(Case{"RodTrack"}, Case{"RodCalculate", "press", ControllerKind::kRodCalculate},
                    Case{"FlexTrack", "press", ControllerKind::kFlexTrack},
                    Case{"StraightTrack", "press", ControllerKind::kStraightTrack},
                    Case{"LateTips", "press", ControllerKind::kRodTrack, 0.062},
                    Case{"FoundModel", "press", ControllerKind::kRodTrack, 0.0, true},
                    Case{"Window", "press", ControllerKind::kRodTrack, 0.0, false, 8},
                    Case{"Direction", "direction", ControllerKind::kRodTrack}),
    [](const auto& info) { return info.param.name; });

TEST(ControllerState, OfAnotherControllerIsRefused) {
  const LoopSetup loop = ScenarioOf(Case{""}).loop;
  InstrumentController one(ControllerOptionsOf(loop));
  StateText out;
  one.VisitState(out);
  InstrumentControllerOptions options = ControllerOptionsOf(loop);
  options.window_samples = 8;
  InstrumentController other(options);
  const auto read = [&](const std::string& text) {
    StateText in(text);
    other.VisitState(in);
    in.Finish();
  };
  EXPECT_THROW(read(out.Text()), InputError);
}

}  // namespace
}  // namespace flextip::simulation
