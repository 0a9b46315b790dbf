// Pictures and videos that state what no camera has: they are refused before memory is asked for.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.h"
#include "recording/frames/frame_source.h"
#include "recording/frames/frames.h"
#include "recording/frames/image_head.h"
#include "recording/frames/video_info.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::Refusal;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using ::testing::HasSubstr;
using namespace std::string_literals;

std::string Bytes(std::uint32_t value, bool big_endian) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) {
    bytes += static_cast<char>(value >> 8 * (big_endian ? 3 - i : i));
  }
  return bytes;
}

/// Writes a picture of 3 x 2 pixels, and returns its bytes.
std::string Picture(const std::filesystem::path& file) {
  EXPECT_TRUE(cv::imwrite(file.string(), cv::Mat(2, 3, CV_8UC1, cv::Scalar(7))));
  return ReadText(file);
}

class StatedBy : public ::testing::TestWithParam<const char*> {
 protected:
  /// Writes a picture of the kind that states this size.
  void State(std::uint32_t width_px, std::uint32_t height_px) {
    const std::string kind = GetParam();
    std::string bytes = Picture(file());
    if (kind == "png") bytes.replace(16, 8, Bytes(width_px, true) + Bytes(height_px, true));
    if (kind == "bmp") bytes.replace(18, 8, Bytes(width_px, false) + Bytes(height_px, false));
    if (kind == "pgm") {
      const auto at = bytes.find("3 2");
      ASSERT_NE(at, std::string::npos);
      bytes.replace(at, 3, fmt::format("{} {}", width_px, height_px));
    }
    if (kind == "tiff") {
      // The directory's first entries: width and height, each a tag, a type (4: 32 bits), a count.
      bytes = "II*\0\x08\0\0\0\x02\0"s + "\0\x01\x04\0\x01\0\0\0"s + Bytes(width_px, false) +
              "\x01\x01\x04\0\x01\0\0\0"s + Bytes(height_px, false) + "\0\0\0\0"s;
    }
    WriteText(file(), bytes);
  }
  std::filesystem::path file() const { return folder_ / ("picture."s + GetParam()); }

  TemporaryFolder folder_;
};

TEST_P(StatedBy, APictureOfMorePixelsThanAnyCameraHas) {
  State(30'000, 20'000);
  EXPECT_EQ(ReadImageHead(file()).problem, "is 30000 x 20000, expected at most 2e+08 pixels");
  EXPECT_THAT(Refusal([&] { ReadImageFile(file()); }), HasSubstr("is 30000 x 20000"));
}

TEST_P(StatedBy, ASideOfNoneOrOfBillions) {
  for (const auto& [width, height] : {std::pair(0U, 2U), std::pair(3U, 0U)}) {
    State(width, height);
    EXPECT_NE(ReadImageHead(file()).problem, "") << width << " x " << height;
    EXPECT_NE(Refusal([&] { ReadImageFile(file()); }), "");
  }
  State(0xffffffffU, 2);
  EXPECT_THAT(ReadImageHead(file()).problem, HasSubstr("4294967295 x 2, expected at most"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, StatedBy, ::testing::Values("png", "bmp", "pgm", "tiff"));

// OpenCV would take more kinds, some of which name other files.
TEST(ImageHead, KnowsNoOtherKinds) {
  const TemporaryFolder folder;
  const auto file = folder / "picture.webp";
  Picture(file);
  EXPECT_EQ(ReadImageHead(file).problem, "is not an image that can be read");
}

/// Writes a video whose head states `scale` seconds for `rate` frames.
void WriteVideo(const std::filesystem::path& file, std::uint32_t scale, std::uint32_t rate) {
  {
    cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                          cv::Size(32, 24));
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < 8; ++i) video.write(cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(10.0 * i)));
  }
  std::string bytes = ReadText(file);
  const auto at = bytes.find("strh");  // then its size, two names, flags, two words, the start
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 28, 8, Bytes(scale, false) + Bytes(rate, false));
  WriteText(file, bytes);
}

// The video library would open what they name, or wait for more of it.
TEST(Video, IsNoListOfOtherFiles) {
  const TemporaryFolder folder;
  WriteVideo(folder / "other.avi", 1, 25);
  for (const char* list : {"#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nother.avi\n",
                           "ffconcat version 1.0\nfile other.avi\n",
                           "v=0\no=- 0 0 IN IP4 127.0.0.1\nm=video 5004 RTP/AVP 96\n"}) {
    const auto file = folder / "v.mp4";
    WriteText(file, list);
    EXPECT_FALSE(IsVideo(file)) << list;
    EXPECT_THAT(Refusal([&] { ReadVideoInfo(file); }), HasSubstr("is not a video"));
    EXPECT_THAT(Refusal([&] { OpenPlainFrames(file, CameraCalibration{}, {}); }),
                HasSubstr("cannot be opened"));
    EXPECT_THAT(Refusal([&] { OpenLiveFrames(file.string(), CameraCalibration{}); }),
                HasSubstr("cannot be opened"));
  }
}

TEST(Video, OfEveryContainerIsKnown) {
  const TemporaryFolder folder;
  for (const auto& [name, code] :
       {std::pair("v.avi", "MJPG"), std::pair("v.mp4", "mp4v"), std::pair("v.mkv", "XVID"),
        std::pair("v.mov", "mp4v"), std::pair("v.flv", "FLV1"), std::pair("v.wmv", "WMV2"),
        std::pair("v.mpg", "mpg1")}) {
    const auto file = folder / name;
    {
      cv::VideoWriter video(file.string(), cv::CAP_FFMPEG,
                            cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]), 25,
                            cv::Size(32, 32));
      if (!video.isOpened()) continue;  // an encoder that is not there
      for (int i = 0; i < 4; ++i) video.write(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(50)));
    }
    EXPECT_TRUE(IsVideo(file)) << name;
    EXPECT_GE(ReadVideoInfo(file).frames, 3U) << name;
  }
}

TEST(Video, OfAnAbsurdRateStatesNone) {
  const TemporaryFolder folder;
  const auto file = folder / "v.avi";
  CameraCalibration camera;
  camera.width_px = 32;
  camera.height_px = 24;
  camera.rate_hz = 20.0;
  for (const auto& [scale, rate] : {std::pair(2'000'000'000U, 1U), std::pair(1U, 2'000'000U)}) {
    WriteVideo(file, scale, rate);
    EXPECT_EQ(ReadVideoInfo(file).rate_hz, 0.0) << rate << " / " << scale;
    const auto frames = OpenPlainFrames(file, camera, {});
    for (TimeNs i = 0; i < 8; ++i) {
      const auto frame = frames->Next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->t_ns, i * 50'000'000);
    }
  }
}

}  // namespace
}  // namespace flextip
