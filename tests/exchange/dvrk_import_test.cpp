// Sessions as the versions of the dVRK's recorder leave them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "recording/frames/frames.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::PlanWithSettings;
using test_support::Refusal;
using testing::Contains;
using testing::HasSubstr;

constexpr int kVideoFrames = 5;
constexpr TimeNs kFirst = 1'700'000'000'200'000'000;

class DvrkImport : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "s/rosbag_1");
    std::filesystem::copy_file(
        std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/bags/ros2_plain.mcap",
        folder_ / "s/rosbag_1/rosbag_1_0.mcap");
    for (const char* eye : {"left", "right"}) {
      VideoFile video(folder_ / "s" / (std::string(eye) + ".mp4"), 25.0);
      for (int i = 0; i < kVideoFrames; ++i) video.Add(Image(64, 48, 3));
      video.Finish();
    }
    WriteText(folder_ / "s/left.json",
              R"({"type": "dvrk_data:sidecar@1.0.0", "estimated_latency": 0.1, "side_by_side": )"
              R"("undefined", "frames": [)" +
                  Frames() + "]}");
    WriteText(folder_ / "s/right.json", R"({"timestamps_ns": [)" + Times() + "]}");
    WriteText(folder_ / "camera.yaml",
              "resolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [60, 60, 31.5, 23.5]\n"
              "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
  }

  // The times as a list, or inside what stands before and behind each.
  static std::string Times(const char* before = "", const char* behind = "") {
    std::string text;
    for (int i = 0; i < kVideoFrames; ++i) {
      text += fmt::format("{}{}{}{}", i > 0 ? ", " : "", before, kFirst + 40'000'000 * i, behind);
    }
    return text;
  }
  static std::string Frames() { return Times(R"({"cpu_ns": )", R"(, "gst_ns": 0})"); }

  ImportPlan Plan() const {
    ImportPlan plan = PlanWithSettings();
    plan.session = folder_ / "s";
    plan.streams["wrist0"].topic = "/PSM1/measured_cp";
    plan.cameras["cam0"].camera = folder_ / "camera.yaml";
    return plan;
  }

  TemporaryFolder folder_;
};

const char* const kOldIndex =
    R"({"videos": [{"file": "left.mp4", "duration": 0.2}, {"file": "right.mp4"}],
        "rosbag": {"name": "rosbag_1", "duration": 1, "message_count": 3}})";
const char* const kNewIndex =
    R"({"type": "dvrk_data:index@1.0.0", "rosbags": "rosbag_1", "streams": [
        {"name": "left", "videos": [{"file": "left.mp4", "duration": 0.2, "frames": 5}]},
        {"name": "right", "videos": [{"file": "right.mp4", "duration": 0.2, "frames": 5}]}]})";

TEST_F(DvrkImport, TakesBagAndVideosWithTheirTimes) {
  for (const char* index : {kOldIndex, kNewIndex}) {
    WriteText(folder_ / "s/index.json", index);
    const Imported imported = Import(Plan());
    EXPECT_EQ(imported.recording.wrist0->samples.size(), 40U);
    ASSERT_TRUE(imported.recording.cam0);
    const auto& frames = imported.recording.cam0->frame_numbers;
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(kVideoFrames));
    EXPECT_EQ(frames[2].t_ns, kFirst + 80'000'000 - 100'000'000);
    EXPECT_THAT(imported.log.warnings, Contains(HasSubstr("0.1 s, is taken off")));
    // No file tells the lens of the right video: the bag's own pictures are the right eye.
    ASSERT_TRUE(imported.recording.cam1);
    EXPECT_EQ(imported.recording.cam1->video, "");
    EXPECT_THAT(imported.log.warnings, Contains(HasSubstr("right.mp4 is left out")));
  }
}

TEST_F(DvrkImport, TakesBothEyesWhereBothLensesAreTold) {
  WriteText(folder_ / "s/index.json", kNewIndex);
  ImportPlan plan = Plan();
  plan.cameras["cam1"].camera = folder_ / "camera.yaml";
  const Imported imported = Import(plan);
  ASSERT_TRUE(imported.recording.cam0 && imported.recording.cam1);
  EXPECT_EQ(imported.recording.cam1->video, "right.mp4");
  EXPECT_EQ(imported.recording.cam1->frame_numbers[0].t_ns, kFirst);
}

TEST_F(DvrkImport, FewFramesMayBeLostAtTheEnd) {
  WriteText(folder_ / "s/index.json", kNewIndex);
  ImportPlan plan = Plan();
  plan.cameras["cam1"].camera = folder_ / "camera.yaml";
  WriteText(folder_ / "s/right.json",
            R"({"timestamps_ns": [)" + Times() + ", 1700000000600000000]}");
  const Imported imported = Import(plan);
  EXPECT_EQ(imported.recording.cam1->frame_numbers.size(), static_cast<std::size_t>(kVideoFrames));
  EXPECT_THAT(imported.log.warnings, Contains(HasSubstr("6 times for 5 frames")));
}

TEST_F(DvrkImport, BothEyesInOneFrameAreNotSplit) {
  WriteText(folder_ / "s/index.json", kNewIndex);
  WriteText(folder_ / "s/left.json",
            R"({"side_by_side": "LR", "timestamps_ns": [)" + Times() + "]}");
  ImportPlan plan = Plan();
  plan.cameras.clear();
  EXPECT_THAT(Import(plan).log.warnings, Contains(HasSubstr("both eyes side by side")));
}

TEST_F(DvrkImport, OtherFoldersAreRefused) {
  EXPECT_THAT(Refusal(Plan()), HasSubstr("holds no index.json"));
  WriteText(folder_ / "s/index.json", R"({"videos": 3})");
  EXPECT_THAT(Refusal(Plan()), HasSubstr("is no index of the dVRK's recorder"));
}

}  // namespace
}  // namespace flextip::exchange
