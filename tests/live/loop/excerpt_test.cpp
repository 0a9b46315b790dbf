// A stop of a live run leaves an excerpt: its outputs come again, and it says what was wrong.
#include "live/recorder/excerpt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/error.h"
#include "live/recorder/recorder.h"
#include "live/recorder/replay.h"
#include "recording/recording_reader.h"
#include "recording/text/text.h"
#include "tests/live/loop/peer.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A run that is recorded; it follows the camera's tip, which nobody else can replace.
struct Recorded : Running {
  explicit Recorded(const std::string& more = "") : Running(Text() + more) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    recorder.emplace(folder, session);
  }
  static std::string Text() {
    std::string text = SessionText() + "supervisor: {fault_after_s: 0.3}\n";
    const auto replace = [&text](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    replace("rod-track", "flex-track");
    replace("speed_m_s: 0.01", "speed_m_s: 0.0005");  // a path of twenty seconds
    return text;
  }

  void Go(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      CycleRecord record;
      record.inputs = peer.Next();
      record.outputs = last = cycle.Step(record.inputs);
      const StreamInputs& streams = record.inputs.streams;
      const TimeNs t_ns = record.inputs.t_ns;
      recorder->Take(StreamName::kWrist, {t_ns, t_ns, streams.wrist->value});
      recorder->Take(StreamName::kTip, {streams.tip->t_ns, t_ns, streams.tip->value});
      recorder->Take(StreamName::kStrain, {t_ns, t_ns, streams.strain->value});
      recorder->Take(record);
      peer.Do(last);
    }
  }
  StopsOfRun Finish() {
    recorder->Finish();
    return WriteExcerpts(folder, folder);
  }

  fs::path folder = session.file.parent_path() / "stopped";
  std::optional<Recorder> recorder;
};

TEST_F(Recorded, ItsLastTenSecondsReplayBitForBit) {
  Go(1250);
  ASSERT_EQ(last.hold, Hold::kNone);
  peer.tip_offset_m = 0.008;
  Go(250);
  ASSERT_EQ(peer.state.state, CrtkState::kPaused);
  const StopsOfRun stops = Finish();
  ASSERT_EQ(stops.found, 1U);
  EXPECT_EQ(stops.faults, 1U);
  EXPECT_THAT(stops.kept[0].says, HasSubstr("the camera's tip was "));
  EXPECT_THAT(stops.kept[0].says, HasSubstr("from where strain and wrist put it"));
  EXPECT_THAT(stops.kept[0].says, HasSubstr("paused at 12.8"));
  const fs::path excerpt = folder / stops.kept[0].folder;
  const ReplayedSession replayed = ReplaySession(excerpt, RecordedSession(excerpt));
  // 10 s before the hold, 0.3 s of it and 1 s more, at 100 Hz.
  EXPECT_NEAR(static_cast<double>(replayed.cycles.size()), 1130.0, 3.0);
  EXPECT_EQ(replayed.equal, static_cast<long>(replayed.cycles.size()));
  const ReadResult read = ReadRecording(excerpt);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  const auto& wrist = read.recording.wrist0->samples;
  EXPECT_NEAR(1e-9 * static_cast<double>(wrist.back().t_ns - wrist.front().t_ns), 11.3, 0.05);
  // The state is what makes it so.
  fs::remove(excerpt / "session0/state.txt");
  const ReplayedSession fresh = ReplaySession(excerpt, RecordedSession(excerpt));
  EXPECT_LT(fresh.equal, static_cast<long>(fresh.cycles.size()));
}

struct WatchedAndRecorded : Recorded {
  WatchedAndRecorded() : Recorded("diagnosis: {running: true}\n") {}
};

/// What an excerpt's warnings come from is before it: its replay keeps the recorded ones.
TEST_F(WatchedAndRecorded, ItsExcerptReplaysBitForBit) {
  Go(800);
  peer.tip_offset_m = 0.0015;
  Go(600);
  EXPECT_TRUE(last.cause.IsThere());
  peer.tip_offset_m = 0.02;
  Go(250);
  const StopsOfRun stops = Finish();
  ASSERT_EQ(stops.found, 1U);
  const fs::path excerpt = folder / stops.kept[0].folder;
  for (const fs::path& recording : {folder, excerpt}) {
    const ReplayedSession replayed = ReplaySession(recording, RecordedSession(recording));
    EXPECT_EQ(replayed.equal, static_cast<long>(replayed.cycles.size())) << recording;
  }
}

TEST_F(Recorded, AHealthyRunHasNoExcerpt) {
  Go(200);
  const StopsOfRun stops = Finish();
  EXPECT_EQ(stops.found, 0U);
  EXPECT_FALSE(fs::exists(folder / "stops"));
}

TEST_F(Recorded, DamageIsOneMessage) {
  Go(200);
  peer.tip_offset_m = 0.008;
  Go(100);
  const StopsOfRun stops = Finish();
  ASSERT_EQ(stops.found, 1U);
  const fs::path inside = folder / stops.kept[0].folder / "session0";
  const auto refused = [&](const std::string& says) {
    try {
      ReplaySession(folder / stops.kept[0].folder, session);
      FAIL() << "expected: " << says;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(says));
    }
  };
  const std::string state = ReadTextFile(inside / "state.txt");
  WriteTextFile(inside / "state.txt", state + "1 2 3\n");
  refused("state.txt");
  WriteTextFile(inside / "state.txt", state);
  std::string cycles = ReadTextFile(inside / "cycles.csv");
  const std::string column = "held_by";
  cycles.replace(cycles.find(column), column.size(), "held__by");
  WriteTextFile(inside / "cycles.csv", cycles);
  refused("held_by");
}

/// Older tables have no findings: no stop is found, and they replay.
TEST_F(Recorded, OfATimeBeforeFindingsHasNoStops) {
  Go(200);
  peer.tip_offset_m = 0.008;
  Go(100);
  recorder->Finish();
  const fs::path file = folder / "session0/cycles.csv";
  std::string cycles = ReadTextFile(file);
  std::string old;
  for (std::size_t at = 0; at < cycles.size();) {
    const std::size_t end = cycles.find('\n', at);
    std::string line = cycles.substr(at, end - at);
    for (int i = 0; i < 16; ++i) line.resize(line.rfind(','));
    old += line + "\n";
    at = end + 1;
  }
  WriteTextFile(file, old);
  EXPECT_EQ(WriteExcerpts(folder, folder).found, 0U);
  const ReplayedSession replayed = ReplaySession(folder, RecordedSession(folder));
  EXPECT_EQ(replayed.equal, 300);
}

}  // namespace
}  // namespace flextip::live
