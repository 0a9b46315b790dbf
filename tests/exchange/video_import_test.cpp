// A video with its times, camera and collar.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "exchange/mapping_file.h"
#include "recording/frames/frames.h"
#include "recording/recording_reader.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::PlanWithSettings;
using test_support::Refusal;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kFrames = 8;
const std::string kCameraText =
    "rate_hz: 30\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [60, 60, 31.5, 23.5]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n";
const std::string kPoseText =
    "T_RC: {rows: 4, cols: 4, data: [1,0,0,0.1, 0,1,0,0.2, 0,0,1,0.3, 0,0,0,1]}\n";

class VideoImport : public testing::Test {
 protected:
  void SetUp() override {
    VideoFile video(folder_ / "scope.mp4", 25.0);
    for (int i = 0; i < kFrames; ++i) video.Add(Image(64, 48, 3));
    video.Finish();
    WriteText(folder_ / "camera.yaml", kCameraText);
    WriteText(folder_ / "posed.yaml", kCameraText + kPoseText);
    WriteText(folder_ / "collar.yaml",
              "family: tag36h11\ntags:\n  - {id: 3, size_m: 0.005, T_EG: {rows: 4, cols: 4, data: "
              "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}\n");
  }

  ImportPlan Plan() const {
    ImportPlan plan = PlanWithSettings();
    CameraPlan& camera = plan.cameras["cam0"];
    camera.video = folder_ / "scope.mp4";
    camera.camera = folder_ / "posed.yaml";
    plan.collar = folder_ / "collar.yaml";
    return plan;
  }

  std::vector<TimeNs> ReadBackTimes(const ImportPlan& plan) const {
    WriteImported(folder_ / "out", Import(plan));
    const auto read = ReadRecording(folder_ / "out");
    std::vector<TimeNs> times;
    for (const auto& frame : read.recording.cam0->frame_numbers) times.push_back(frame.t_ns);
    return times;
  }

  TemporaryFolder folder_;
};

TEST_F(VideoImport, TimesComeFromAFile) {
  std::string text, table = "frame,time [ms]\n";
  std::vector<TimeNs> expected;
  for (int i = 0; i < kFrames; ++i) {
    const TimeNs t_ms = 1'700'000'000'000 + 41 * i;
    expected.push_back(t_ms * 1'000'000 + 250'000'000);
    text += std::to_string(t_ms / 1000) + "." + std::to_string(t_ms % 1000 + 1000).substr(1) + "\n";
    table += std::to_string(i) + "," + std::to_string(t_ms) + "\n";
  }
  ImportPlan plan = Plan();
  plan.cameras["cam0"].offset_ns = 250'000'000;
  plan.cameras["cam0"].times.file = folder_ / "times.txt";
  WriteText(folder_ / "times.txt", text);
  EXPECT_EQ(ReadBackTimes(plan), expected);
  std::filesystem::remove_all(folder_ / "out");
  WriteText(folder_ / "times.txt", table);
  EXPECT_EQ(ReadBackTimes(plan), expected);
  WriteText(folder_ / "times.txt", text.substr(0, text.size() - 15));
  EXPECT_THAT(Refusal(plan), HasSubstr("found 7 times, expected 8"));
}

TEST_F(VideoImport, TimesComeFromStartAndRate) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].start = "2024-05-01T12:00:00Z";
  plan.cameras["cam0"].rate_hz = 50;
  const auto times = ReadBackTimes(plan);
  ASSERT_EQ(times.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(times[0], 1'714'564'800'000'000'000);
  EXPECT_EQ(times[3] - times[0], 60'000'000);
  EXPECT_EQ(ReadText(folder_ / "out/cam0/scope.mp4"), ReadText(folder_ / "scope.mp4"));
}

TEST_F(VideoImport, WhatIsAssumedIsSaid) {
  const Imported imported = Import(Plan());
  EXPECT_TRUE(imported.log.assumed.contains("cam0.start"));
  EXPECT_THAT(imported.log.assumed.at("cam0.frame_rate_hz"), HasSubstr("25"));
  EXPECT_EQ(imported.recording.cam0->calibration.T_RC.p, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(imported.recording.tags0->tags.front().id, 3);
}

TEST_F(VideoImport, APoseIsNeverInvented) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].camera = folder_ / "camera.yaml";
  const Imported unplaced = Import(plan);
  EXPECT_FALSE(unplaced.recording.cam0->has_T_RC);
  EXPECT_THAT(unplaced.log.warnings, testing::Contains(HasSubstr("its T_RC is unknown")));
  WriteImported(folder_ / "unplaced", unplaced);
  EXPECT_THAT(ReadText(folder_ / "unplaced/cam0/sensor.yaml"), HasSubstr("T_RC: unknown"));
  EXPECT_FALSE(ReadRecording(folder_ / "unplaced").recording.cam0->has_T_RC);
  plan.cameras["cam0"].pose = folder_ / "pose.yaml";
  WriteText(folder_ / "pose.yaml", kPoseText);
  EXPECT_EQ(Import(plan).recording.cam0->calibration.T_RC.p.z(), 0.3);
  WriteText(folder_ / "pose.yaml", "found:\n  cam0." + kPoseText);
  const Imported placed = Import(plan);
  EXPECT_TRUE(placed.recording.cam0->has_T_RC);
  EXPECT_EQ(placed.recording.cam0->calibration.T_RC.p.z(), 0.3);
}

TEST_F(VideoImport, AStartIsNeverInventedBesideOtherClocks) {
  ImportPlan plan = Plan();
  WriteText(folder_ / "robot.csv", "t [s],x [m],y [m],z [m]\n12.3,0,0,0\n12.4,0,0,0.1\n");
  plan.streams["wrist0"].file = folder_ / "robot.csv";
  plan.sensors["wrist0"].numbers["position_noise_m"] = {1e-4};
  EXPECT_THAT(Refusal(plan), HasSubstr("cam0: no file says when the first frame"));
  plan.cameras["cam0"].start = "12.3";
  EXPECT_EQ(Import(plan).recording.cam0->frame_numbers.front().t_ns, 12'300'000'000);
}

TEST_F(VideoImport, TheRecordersSideCarHoldsTimes) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].times.file = folder_ / "scope.json";
  std::string frames, listed;
  for (int i = 0; i < kFrames; ++i) {
    const TimeNs t_ns = 1'700'000'000'000'000'001 + 40'000'000 * i;
    frames += fmt::format("{}{{\"cpu_ts\": {}, \"gst_ts\": 5}}", i > 0 ? ", " : "", t_ns);
    listed += fmt::format("{}{}", i > 0 ? ", " : "", t_ns);
  }
  for (const auto& text :
       {"{\"type\": \"dc::sidecar@1.0.0\", \"estimated_latency\": 0.05, \"frames\": [" + frames +
            "]}",
        "{\"estimated_latency_ms\": 50, \"timestamps_ns\": [" + listed + "]}"}) {
    WriteText(folder_ / "scope.json", text);
    std::filesystem::remove_all(folder_ / "out");
    const auto times = ReadBackTimes(plan);
    ASSERT_EQ(times.size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(times[0], 1'699'999'999'950'000'001);
    EXPECT_EQ(times[3] - times[0], 120'000'000);
  }
  WriteText(folder_ / "scope.json", "{\"frames\": [{\"cpu_ts\": 1}, {\"cpu_ts\": 2}]}");
  EXPECT_THAT(Refusal(plan), HasSubstr("found 2 times, expected 8"));
  WriteText(folder_ / "scope.json", "{\"frames\": 3}");
  EXPECT_THAT(Refusal(plan), HasSubstr("is no side-car"));
}

TEST_F(VideoImport, ALinkServesAsWell) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].link = true;
  EXPECT_EQ(ReadBackTimes(plan).size(), static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "out/cam0/scope.mp4"));
}

TEST_F(VideoImport, TheMappingMakesItAgain) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].start = "12.5";
  WriteImported(folder_ / "first", Import(plan));
  ImportPlan again;
  ReadMapping(folder_ / "first/import.yaml", again);
  WriteImported(folder_ / "second", Import(again));
  for (const char* file : {"import.yaml", "cam0/data.csv", "cam0/sensor.yaml"}) {
    EXPECT_EQ(ReadText(folder_ / "first" / file), ReadText(folder_ / "second" / file)) << file;
  }
}

TEST_F(VideoImport, OtherFilesAreRefused) {
  ImportPlan plan = Plan();
  plan.cameras["cam0"].video = folder_ / "collar.yaml";
  EXPECT_THAT(Refusal(plan), HasSubstr("is not a video that can be read"));
  plan = Plan();
  WriteText(folder_ / "posed.yaml",
            "rate_hz: 30\nresolution: [80, 48]\ncamera_model: pinhole\nintrinsics: [60, 60, 31, "
            "23]\ndistortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n" +
                kPoseText);
  EXPECT_THAT(Refusal(plan),
              HasSubstr("is of 80 x 48 pixels, expected 64 x 48 as the frames of cam0"));
  plan.cameras["cam0"].camera.clear();
  EXPECT_THAT(Refusal(plan), HasSubstr("does not hold its lens"));
}

}  // namespace
}  // namespace flextip::exchange
