// Pictures of videos against OpenCV's own reader, and videos that are not as they state.
#include "recording/frames/video_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using test_support::ReadText;
using test_support::TemporaryFolder;
using test_support::WriteText;

constexpr int kWidth = 96, kHeight = 64, kFrames = 8;

/// A disc that moves over a slope of colours.
cv::Mat Scene(int i) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      pixel[0] = static_cast<std::uint8_t>(2 * x);
      pixel[1] = static_cast<std::uint8_t>(3 * y);
      pixel[2] = 100;
    }
  }
  cv::circle(picture, {10 + 8 * i, 30}, 9, {250, 250, 250}, cv::FILLED);
  return picture;
}

bool Write(const std::filesystem::path& file, const std::string& code) {
  cv::VideoWriter video(file.string(), cv::CAP_FFMPEG,
                        cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]), 25,
                        cv::Size(kWidth, kHeight));
  for (int i = 0; video.isOpened() && i < kFrames; ++i) video.write(Scene(i));
  return video.isOpened();
}

cv::Mat View(const Image& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8UC3,
                 const_cast<std::uint8_t*>(image.data.data()));  // only read
}

std::vector<Image> Pictures(VideoReader& video) {
  std::vector<Image> pictures;
  while (video.Advance()) pictures.push_back(video.Picture().value());
  return pictures;
}

std::vector<Image> Pictures(const std::filesystem::path& file) {
  const auto video = VideoReader::Open(file.string());
  return video ? Pictures(*video) : std::vector<Image>{};
}

void ExpectAsOpenCv(const std::filesystem::path& file) {
  cv::VideoCapture peer(file.string(), cv::CAP_FFMPEG);
  const auto video = VideoReader::Open(file.string());
  ASSERT_TRUE(peer.isOpened() && video);
  EXPECT_EQ(video->Width_px(), peer.get(cv::CAP_PROP_FRAME_WIDTH));
  EXPECT_EQ(video->Height_px(), peer.get(cv::CAP_PROP_FRAME_HEIGHT));
  EXPECT_EQ(video->StatedRate(), peer.get(cv::CAP_PROP_FPS));
  EXPECT_EQ(video->StatedFrames(), peer.get(cv::CAP_PROP_FRAME_COUNT));
  const auto pictures = Pictures(*video);
  EXPECT_EQ(pictures.size(), std::size_t{kFrames});
  for (const Image& picture : pictures) {
    cv::Mat wanted;
    ASSERT_TRUE(peer.read(wanted));
    ASSERT_EQ(wanted.cols, picture.width_px);
    ASSERT_EQ(wanted.rows, picture.height_px);
    EXPECT_LE(cv::norm(View(picture), wanted, cv::NORM_INF), 2.0);
  }
}

TEST(VideoReader, GivesThePicturesThatOpenCvGives) {
  const TemporaryFolder folder;
  int compared = 0;
  for (const auto& [name, code] : {std::pair("v.avi", "MJPG"), std::pair("v.mp4", "mp4v"),
                                   std::pair("h.mp4", "avc1"), std::pair("v.mkv", "XVID")}) {
    SCOPED_TRACE(code);
    if (!Write(folder / name, code)) continue;  // an encoder that is not there
    ExpectAsOpenCv(folder / name);
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// Has an MP4 file say that its pictures are to be turned.
void Turn(const std::filesystem::path& file, int cosine, int sine) {
  std::string bytes = ReadText(file);
  const auto track = bytes.find("tkhd");
  ASSERT_NE(track, std::string::npos);
  constexpr std::size_t kBeforeTheMatrix = 44;  // name, flags, times, number, duration, layer
  std::string matrix;
  for (const int value : {cosine, sine, 0, -sine, cosine, 0, 0, 0}) {
    matrix += BigEndian(static_cast<std::uint32_t>(value) << 16);
  }
  bytes.replace(track + kBeforeTheMatrix, matrix.size(), matrix);
  WriteText(file, bytes);
}

// The matrix takes what lies to the right, with y down, to (cosine, sine). OpenCV 4.6 turns the
// other way.
TEST(VideoReader, SetsPicturesUpright) {
  const TemporaryFolder folder;
  const auto file = folder / "v.mp4";
  ASSERT_TRUE(Write(file, "mp4v"));
  const Image lying = Pictures(file).at(3);
  for (const auto& [cosine, sine, turn] :
       {std::tuple(0, 1, cv::ROTATE_90_CLOCKWISE), std::tuple(-1, 0, cv::ROTATE_180),
        std::tuple(0, -1, cv::ROTATE_90_COUNTERCLOCKWISE)}) {
    SCOPED_TRACE(turn);
    ASSERT_TRUE(Write(file, "mp4v"));
    Turn(file, cosine, sine);
    const auto video = VideoReader::Open(file.string());
    ASSERT_TRUE(video);
    const Image upright = Pictures(*video).at(3);
    EXPECT_EQ(video->Width_px(), upright.width_px);
    cv::Mat wanted;
    cv::rotate(View(lying), wanted, turn);
    ASSERT_EQ(wanted.size(), cv::Size(upright.width_px, upright.height_px));
    EXPECT_EQ(cv::norm(View(upright), wanted, cv::NORM_INF), 0.0);
  }
}

// Later pictures would have the numbers, and so the times, of earlier ones.
TEST(VideoReader, AFileEndsAtItsFirstDamagedPicture) {
  const TemporaryFolder folder;
  const auto file = folder / "v.avi";
  ASSERT_TRUE(Write(file, "MJPG"));
  std::string bytes = ReadText(file);
  std::size_t at = bytes.find("movi");
  for (int i = 0; i <= 3; ++i) at = bytes.find("00dc", at + 1);
  ASSERT_NE(at, std::string::npos);
  const std::size_t length =
      static_cast<std::uint8_t>(bytes[at + 4]) + 256 * static_cast<std::uint8_t>(bytes[at + 5]);
  bytes.replace(at + 8, length, std::string(length, '\x55'));
  WriteText(file, bytes);
  EXPECT_EQ(Pictures(file).size(), 3U);
}

TEST(VideoReader, OpensNoFileThatIsNone) {
  const TemporaryFolder folder;
  WriteText(folder / "v.mp4", "no video");
  EXPECT_EQ(VideoReader::Open((folder / "v.mp4").string()), nullptr);
  EXPECT_EQ(VideoReader::Open((folder / "missing.mp4").string()), nullptr);
  ASSERT_TRUE(Write(folder / "whole.mp4", "mp4v"));
  WriteText(folder / "v.mp4", ReadText(folder / "whole.mp4").substr(0, 60));
  EXPECT_EQ(VideoReader::Open((folder / "v.mp4").string()), nullptr);
}

}  // namespace
}  // namespace flextip
