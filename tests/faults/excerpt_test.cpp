// A stop of a simulated run leaves an excerpt: its commands come again, and it says what was wrong.
#include "simulation/closed_loop/excerpt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "core/error.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"
#include "simulation/closed_loop/given_streams.h"
#include "simulation/closed_loop/loop_table.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip::simulation {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kStart_s = 0.5;

Scenario Press(ControllerKind kind, const std::vector<Fault>& faults) {
  Scenario scenario =
      ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml");
  LoopSetup& loop = scenario.loop;
  loop.plant_options = {30, 30};
  loop.controller.kind = kind;
  loop.supervision.kind = SupervisionKind::kFull;
  loop.supervision.fault_after_s = 0.3;
  loop.supervision.rate_hz = loop.update_rate_hz;
  loop.faults = faults;
  loop.max_s = 2.5;
  return scenario;
}

class Excerpts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("flextip-excerpt-" + std::to_string(getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Runs the press, writes its recording and the excerpts.
  StopsOfRun Run(ControllerKind kind, const std::vector<Fault>& faults) {
    scenario_ = Press(kind, faults);
    kind_ = kind;
    LoopTableWriter table;
    GivenStreams given(scenario_.loop);
    Scenario noted = scenario_;
    noted.loop.note_cycle = [&](const LoopCycle& cycle) {
      table.Add(cycle);
      given.Add(cycle);
    };
    LoopResult result = RunController(noted, kind, nullptr);
    given.PutInto(result.recording);
    WriteRecording(folder_, result.recording);
    WriteTextFile(folder_ / "loop0/cycles.csv", table.Text());
    return WriteExcerpts(scenario_, kind, folder_, folder_);
  }

  void ExpectReplays(const fs::path& recording) const {
    const auto commands = ReplayLoop(scenario_, kind_, recording);
    ASSERT_GT(commands.size(), 20U);
    for (const ReplayedCommand& command : commands) ASSERT_TRUE(command.equal) << command.t_ns;
  }

  fs::path folder_;
  Scenario scenario_;
  ControllerKind kind_ = ControllerKind::kRodTrack;
};

/// flex-track needs its camera: a tip that is off holds the wrist until a person goes on.
TEST_F(Excerpts, ATipThatIsOffIsNamedAndItsCommandsComeAgain) {
  const StopsOfRun stops = Run(ControllerKind::kFlexTrack,
                               {{FaultKind::kOffset, FaultStream::kTip, kStart_s, 10.0, 0.008}});
  ASSERT_EQ(stops.found, 1U);
  EXPECT_EQ(stops.faults, 1U);
  EXPECT_THAT(stops.kept[0].says, HasSubstr("tip_disagrees: the camera's tip was "));
  EXPECT_THAT(stops.kept[0].says, HasSubstr("from where EM, strain and wrist put it"));
  EXPECT_THAT(stops.kept[0].says, HasSubstr("paused at 0.8"));
  // The fault is 8 mm, and the shaft bends between the estimate's noise.
  const std::string words = "tip was ";
  const double said_mm =
      std::stod(stops.kept[0].says.substr(stops.kept[0].says.find(words) + words.size()));
  EXPECT_NEAR(said_mm, 8.0, 1.0);
  const fs::path excerpt = folder_ / stops.kept[0].folder;
  ExpectReplays(folder_);
  ExpectReplays(excerpt);
  const ReadResult read = ReadRecording(excerpt);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  EXPECT_FALSE(read.recording.vision0->tips.empty());
  EXPECT_FALSE(fs::exists(excerpt / "truth0"));
}

TEST_F(Excerpts, BeginsInTheMiddleOfARun) {
  const StopsOfRun stops = Run(ControllerKind::kFlexTrack,
                               {{FaultKind::kOffset, FaultStream::kTip, kStart_s, 10.0, 0.008}});
  ASSERT_EQ(stops.found, 1U);
  // The run from its second second on, as an excerpt of a long run begins.
  const fs::path file = folder_ / "loop0/cycles.csv";
  ReadLog log;
  LoopTableReader table(file, log);
  std::vector<LoopCycle> cycles;
  while (const auto cycle = table.Next()) cycles.push_back(*cycle);
  InstrumentController controller(ControllerOptionsOf([&] {
    LoopSetup setup = scenario_.loop;
    setup.controller.kind = kind_;
    return setup;
  }()));
  const std::size_t from = 30;
  for (std::size_t i = 0; i < from; ++i) controller.Step(InputsOf(cycles[i]));
  StateText state;
  controller.VisitState(state);
  LoopTableWriter rest;
  for (std::size_t i = from; i < cycles.size(); ++i) rest.Add(cycles[i]);
  WriteTextFile(folder_ / "rest/loop0/cycles.csv", rest.Text());
  WriteTextFile(folder_ / "rest/loop0/state.txt", state.Text());
  ExpectReplays(folder_ / "rest");
  // Without the state the same rows come out otherwise.
  fs::remove(folder_ / "rest/loop0/state.txt");
  const auto commands = ReplayLoop(scenario_, kind_, folder_ / "rest");
  EXPECT_FALSE(std::all_of(commands.begin(), commands.end(),
                           [](const ReplayedCommand& command) { return command.equal; }));
}

TEST_F(Excerpts, APortThatMovedIsAStop) {
  const StopsOfRun stops =
      Run(ControllerKind::kRodTrack,
          {{FaultKind::kPortMoved, FaultStream::kPlant, kStart_s, 10.0, 0.01}});
  ASSERT_GE(stops.found, 1U);
  ExpectReplays(folder_ / stops.kept[0].folder);
}

TEST_F(Excerpts, AHealthyRunHasNone) {
  EXPECT_EQ(Run(ControllerKind::kRodTrack, {}).found, 0U);
  EXPECT_FALSE(fs::exists(folder_ / "stops"));
  ExpectReplays(folder_);
}

TEST_F(Excerpts, WhatIsDamagedIsOneMessage) {
  Run(ControllerKind::kFlexTrack, {{FaultKind::kOffset, FaultStream::kTip, kStart_s, 10.0, 0.008}});
  const fs::path excerpt = folder_ / "stops/1_tip_disagrees";
  const auto refused = [&](const std::string& says) {
    try {
      ReplayLoop(scenario_, kind_, excerpt);
      FAIL() << "expected: " << says;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(says));
    }
  };
  const std::string state = ReadTextFile(excerpt / "loop0/state.txt");
  WriteTextFile(excerpt / "loop0/state.txt", state.substr(0, state.size() / 2));
  refused("state.txt");
  WriteTextFile(excerpt / "loop0/state.txt", state);
  std::string cycles = ReadTextFile(excerpt / "loop0/cycles.csv");
  const std::string column = "found_chi2 []";
  cycles.replace(cycles.find(column), column.size(), "other []");
  WriteTextFile(excerpt / "loop0/cycles.csv", cycles);
  refused("found_chi2");
}

}  // namespace
}  // namespace flextip::simulation
