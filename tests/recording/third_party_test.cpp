// Recordings made by other programs and on real robots.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "recording/frames/image_head.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using ::testing::IsEmpty;

const std::filesystem::path kRecordings = FLEXTIP_SOURCE_DIR "/testdata/recordings";
/// Data of others, which is not in the project.
const std::filesystem::path kShared = FLEXTIP_SHARED_DIR "/data";
const std::filesystem::path kOpenCvDoc = "/usr/share/doc/opencv-doc/examples/data";

/// Lines after the header, counted without the reader.
std::size_t Rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  return lines - 1;
}

/// Reads the recording in `path`, and writes and reads it again without a change.
void ExpectReadsWhole(const std::filesystem::path& path) {
  SCOPED_TRACE(path.string());
  const flextip::test_support::TemporaryFolder folder;
  const auto result = ReadRecording(path);
  const auto& r = result.recording;
  EXPECT_THAT(result.warnings, IsEmpty());
  ASSERT_TRUE(r.wrist0 && r.vision0);
  EXPECT_EQ(r.wrist0->samples.size(), Rows(path / "wrist0/data.csv"));
  EXPECT_EQ(r.vision0->tips.size(), Rows(path / "vision0/data.csv"));
  if (r.em0) {
    EXPECT_EQ(r.em0->samples.size(), Rows(path / "em0/data.csv"));
  }
  if (r.strain0) {
    EXPECT_EQ(r.strain0->moments_Nm.size(), Rows(path / "strain0/data.csv"));
  }
  EXPECT_EQ(r.em0.has_value(), std::filesystem::exists(path / "em0"));
  EXPECT_EQ(r.load0.has_value(), std::filesystem::exists(path / "load0"));
  // What was read, written and read again is written in the same bytes.
  WriteRecording(folder / "once", r);
  WriteRecording(folder / "twice", ReadRecording(folder / "once").recording);
  for (const char* file : {"recording.yaml", "wrist0/data.csv", "vision0/data.csv"}) {
    EXPECT_EQ(flextip::test_support::ReadText(folder / "once" / file),
              flextip::test_support::ReadText(folder / "twice" / file));
  }
}

TEST(ThirdParty, SampleRecordingsReadWholeAndWithoutWarnings) {
  for (int i = 0; i < 6; ++i) ExpectReadsWhole(kRecordings / fmt::format("sample_{}", i));
}

TEST(ThirdParty, RecordingsOfRealArmsReadWholeAndWithoutWarnings) {
  if (!std::filesystem::exists(kShared / "recordings")) GTEST_SKIP() << "no shared recordings";
  for (const char* name : {"dvrk_insertion_a", "dvrk_press_x"})
    ExpectReadsWhole(kShared / "recordings" / name);
}

TEST(ThirdParty, ValuesAreTheFilesOwn) {
  const auto path = kRecordings / "sample_0";
  const auto r = ReadRecording(path).recording;
  EXPECT_EQ(r.instrument.bending_stiffness_Nm2, 0.303973018);
  EXPECT_EQ(r.p_RP, Eigen::Vector3d(-0.00976031379, 0.01710896, -0.00173916909));
  EXPECT_EQ(r.wrist0->samples[1].t_ns, 1700000000020000000);
  EXPECT_EQ(r.wrist0->samples[1].value.p_RW,
            Eigen::Vector3d(-0.372771583, 0.0741045315, -0.0824647184));
  EXPECT_NEAR(r.wrist0->samples[1].value.q_RW->w(), 0.990319027, 2e-9);
  EXPECT_NEAR(r.wrist0->samples[1].value.q_RW->z(), -0.0769893472, 2e-9);
  EXPECT_EQ(r.strain0->moments_Nm[0].value[2], 0.0329003582);
  EXPECT_EQ(r.vision0->tips[0].value.covariance_m2(0, 2), -3.42708075e-08);
  EXPECT_EQ(r.vision0->tips[0].value.covariance_m2(1, 1), 8.47701863e-09);
  EXPECT_EQ(r.em0->distance_from_tip_m, 0.02);
}

TEST(ThirdParty, UnmeasuredOrientationsAndDirectionsAreAbsent) {
  const auto path = kShared / "recordings/dvrk_press_x";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared recordings";
  const auto r = ReadRecording(path).recording;
  for (const auto& sample : r.wrist0->samples) EXPECT_FALSE(sample.value.q_RW.has_value());
  for (const auto& sample : r.vision0->tips) EXPECT_FALSE(sample.value.d_RE.has_value());
}

TEST(ThirdParty, TheRenderedRecordingReads) {
  const auto result = ReadRecording(kRecordings / "rendered");
  EXPECT_THAT(result.warnings, IsEmpty());
  EXPECT_EQ(result.recording.cam0->filenames.size(), 8u);
  EXPECT_EQ(result.recording.cam0->calibration.gamma, 2.2);
  ASSERT_EQ(result.recording.tags0->tags.size(), 6u);
  const Pose& T_EG = result.recording.tags0->tags[4].T_EG;
  EXPECT_NEAR((T_EG.R.transpose() * T_EG.R - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
  EXPECT_NEAR(T_EG.R(1, 1), 0.866025404, 2e-9);
}

/// Compares the heads of up to 40 pictures below `folder` with OpenCV's decoder. Returns their
/// count.
int CheckHeads(const std::filesystem::path& folder) {
  int images = 0;
  std::error_code absent;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, absent)) {
    const auto kind = entry.path().extension();
    if ((kind != ".png" && kind != ".jpg") || images >= 40) continue;
    const cv::Mat image = cv::imread(entry.path().string(), cv::IMREAD_UNCHANGED);
    const auto head = ReadImageHead(entry.path());
    EXPECT_EQ(head.problem, "") << entry.path();
    EXPECT_EQ(cv::Size(head.width_px, head.height_px), image.size()) << entry.path();
    ++images;
  }
  return images;
}

TEST(ThirdParty, HeadsOfImagesAgreeWithTheDecoder) {
  EXPECT_EQ(CheckHeads(kRecordings), 8);
  for (const auto& folder : {kOpenCvDoc, kShared}) {
    if (std::filesystem::exists(folder)) {
      EXPECT_GT(CheckHeads(folder), 10) << folder;
    }
  }
}

}  // namespace
}  // namespace flextip
