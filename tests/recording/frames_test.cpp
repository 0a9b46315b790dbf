#include <gmock/gmock.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.h"
#include "recording/frames/frame_source.h"
#include "recording/frames/image_head.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::kHeight;
using flextip::test_support::kSamples;
using flextip::test_support::kWidth;
using flextip::test_support::Line;
using flextip::test_support::ReadText;
using flextip::test_support::ReplaceLine;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;
using flextip::test_support::WriteText;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Failure(const std::filesystem::path& folder, const ReadOptions& options = {}) {
  try {
    ReadRecording(folder, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without an error";
}

TEST(ImageHead, AgreesWithTheDecoderOnEveryKind) {
  const TemporaryFolder folder;
  int count = 0;
  for (const char* kind : {".png", ".jpg", ".bmp", ".pgm"}) {
    for (const auto& size : {cv::Size(1, 1), cv::Size(33, 7), cv::Size(1920, 1081)}) {
      for (const int type : {CV_8UC1, CV_8UC3}) {
        if (type == CV_8UC3 && std::string(kind) == ".pgm") continue;
        const auto file = folder / (std::to_string(count++) + kind);
        ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(size, type, cv::Scalar::all(99))));
        const auto head = ReadImageHead(file);
        EXPECT_EQ(head.problem, "") << file;
        EXPECT_EQ(head.width_px, size.width) << file;
        EXPECT_EQ(head.height_px, size.height) << file;
      }
    }
  }
  EXPECT_EQ(count, 21);
}

TEST(ImageHead, EveryCutOfAnImageIsNoticed) {
  const TemporaryFolder folder;
  for (const char* kind : {".png", ".jpg"}) {
    const auto file = folder / (std::string("a") + kind);
    ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(40, 50, CV_8UC1, cv::Scalar(7))));
    const std::string whole = ReadText(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      WriteText(file, whole.substr(0, size));
      EXPECT_NE(ReadImageHead(file).problem, "") << kind << " of " << size << " bytes";
    }
    WriteText(file, whole + "appended by a camera");
    EXPECT_EQ(ReadImageHead(file).problem, "");
  }
}

TEST(Frames, MissingEmptyBrokenAndWrongOnesAreRejected) {
  const TemporaryFolder folder;
  const auto frame = folder / "cam0/data/3.png";  // of line 5
  const auto expect = [&](const char* message) {
    EXPECT_THAT(Failure(folder.path()), HasSubstr("cam0/data.csv:5: the frame "));
    EXPECT_THAT(Failure(folder.path()), HasSubstr(message));
    EXPECT_EQ(Failure(folder.path(), {.check_frames = false}), "read without an error");
  };
  WriteSample(folder.path());
  std::filesystem::remove(frame);
  expect("3.png is missing");
  WriteText(frame, "");
  expect("3.png is empty");
  WriteText(frame, "no image");
  expect("3.png is not an image");
  WriteText(frame, ReadText(folder / "cam0/data/2.png").substr(0, 60));
  expect("3.png is cut off");
  cv::imwrite(frame.string(), cv::Mat(kHeight, kWidth + 1, CV_8UC1, cv::Scalar(1)));
  expect("3.png is 33 x 24, expected 32 x 24");
}

TEST(Frames, DroppedOnesAreCountedAndSkipped) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const auto file = folder / "cam0/data.csv";
  const std::string row = Line(file, 4);
  ReplaceLine(file, 4, row.substr(0, row.find(',') + 1));  // the recorder's note, frame 2
  auto result = ReadRecording(folder.path());
  EXPECT_EQ(result.dropped_frames, 1);
  EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("cam0/data.csv: skipped 1 dropped frames")));
  EXPECT_EQ(result.recording.cam0->filenames.size(), kSamples - 1u);
  EXPECT_EQ(result.recording.cam0->filenames[2].value, "3.png");

  Recording gap = flextip::test_support::MakeRecording();
  gap.cam0->filenames.erase(gap.cam0->filenames.begin() + 2);
  WriteRecording(folder.path(), gap);
  result = ReadRecording(folder.path());
  EXPECT_EQ(result.dropped_frames, 1);
  EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("data.csv: about 1 frames dropped")));
  EXPECT_EQ(result.recording.cam0->filenames, gap.cam0->filenames);
}

TEST(Frames, OnlyTheCalibrationMayBeThere) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  std::filesystem::remove(folder / "cam0/data.csv");
  EXPECT_THAT(Failure(folder.path()), HasSubstr("cam0/data.csv: no such file, but frames"));
  std::filesystem::remove_all(folder / "cam0/data");
  const auto camera = ReadRecording(folder.path()).recording.cam0;
  EXPECT_EQ(camera->calibration.width_px, kWidth);
  EXPECT_TRUE(camera->filenames.empty());
}

Recording WithVideo(const std::vector<int>& frames) {
  Recording recording = flextip::test_support::MakeRecording();
  recording.cam1.reset();
  auto& camera = *recording.cam0;
  camera.filenames.clear();
  camera.video = "frames.avi";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    camera.frame_numbers.push_back({static_cast<TimeNs>(i) * 40'000'000, frames[i]});
  }
  return recording;
}

void WriteVideo(const std::filesystem::path& file, int width, int frames) {
  cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                        cv::Size(width, kHeight));
  ASSERT_TRUE(video.isOpened());
  for (int i = 0; i < frames; ++i) {
    video.write(cv::Mat(kHeight, width, CV_8UC3, cv::Scalar::all(10.0 * i)));
  }
}

TEST(Frames, OfAVideoAreReadAndChecked) {
  const TemporaryFolder folder;
  const auto video = folder / "cam0/frames.avi";
  const auto recording = WithVideo({0, 1, 4, 5});
  WriteRecording(folder.path(), recording);
  EXPECT_THAT(Failure(folder.path()), HasSubstr("frames.avi is missing"));
  WriteVideo(video, kWidth, 6);
  const auto result = ReadRecording(folder.path());
  EXPECT_THAT(result.warnings, ::testing::IsEmpty());
  EXPECT_EQ(result.recording.cam0->frame_numbers, recording.cam0->frame_numbers);
  EXPECT_EQ(result.recording.cam0->video, "frames.avi");

  WriteVideo(video, kWidth, 5);
  EXPECT_THAT(Failure(folder.path()), HasSubstr("cam0/data.csv:5: frame 5 is missing: "));
  WriteVideo(video, kWidth + 16, 6);
  EXPECT_THAT(Failure(folder.path()), HasSubstr("frames.avi is 48 x 24, expected 32 x 24"));
  EXPECT_THAT(Failure(folder.path()), HasSubstr("cam0/sensor.yaml:"));
  WriteText(video, "no video");
  EXPECT_THAT(Failure(folder.path()), HasSubstr("frames.avi is not a video"));
  WriteRecording(folder.path(), WithVideo({0, 1, 1}));
  EXPECT_THAT(Failure(folder.path()), HasSubstr("data.csv:4: found frame 1, expected more than 1"));
}

TEST(Frames, OfAFileThatStandsInForACameraComeAtItsRate) {
  const TemporaryFolder folder;
  constexpr int kFrames = 6;
  WriteVideo(folder / "v.avi", kWidth, kFrames);
  CameraCalibration camera;
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  const auto frames = OpenLiveFrames((folder / "v.avi").string(), camera);
  const auto begin = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last;
  int seen = 0;
  for (; frames->Next(); ++seen) last = std::chrono::steady_clock::now();
  ASSERT_EQ(seen, kFrames);
  constexpr std::chrono::milliseconds kPeriod(40);  // 25 Hz; a busy machine is later, never earlier
  EXPECT_GE(last - begin, (kFrames - 1) * kPeriod);
}

}  // namespace
}  // namespace flextip
