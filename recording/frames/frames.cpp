#include "recording/frames/frames.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "core/error.h"
#include "recording/frames/image_head.h"

namespace flextip {
namespace {

cv::Mat View(const Image& image) {
  return cv::Mat(image.height_px, image.width_px, image.channels == 3 ? CV_8UC3 : CV_8UC1,
                 const_cast<std::uint8_t*>(image.data.data()));  // only read
}

cv::Mat Decode(const std::filesystem::path& file) {
  const ImageHead head = ReadImageHead(file);
  if (!head.problem.empty()) {
    throw InputError::At(file.string(), 0, fmt::format("the image {}", head.problem));
  }
  cv::Mat picture;
  try {
    const QuietStderr quiet;
    constexpr int kAsStored = cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH;
    picture = cv::imread(file.string(), kAsStored | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // reported below
  }
  if (picture.empty()) throw InputError::At(file.string(), 0, "the image cannot be decoded");
  if (picture.depth() != CV_8U && picture.depth() != CV_16U) {
    throw InputError::At(file.string(), 0, "expected an image of 8 or 16 bits");
  }
  return picture;
}

}  // namespace

QuietStderr::QuietStderr() : saved_(dup(STDERR_FILENO)) {
  std::fflush(stderr);
  const int nothing = open("/dev/null", O_WRONLY);
  if (saved_ >= 0 && nothing >= 0) dup2(nothing, STDERR_FILENO);
  if (nothing >= 0) close(nothing);
}

QuietStderr::~QuietStderr() {
  if (saved_ < 0) return;
  dup2(saved_, STDERR_FILENO);
  close(saved_);
}

void SilenceVideoCodecs() {
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

Image ReadGreyOrColour(const std::filesystem::path& file, const GreyRange& range) {
  cv::Mat picture = Decode(file);
  Image image(picture.cols, picture.rows, picture.channels());
  const double scale = 255.0 / (range.white - range.black);
  cv::Mat target = View(image);
  if (picture.depth() == CV_16U) {
    picture.convertTo(target, CV_8U, scale, -scale * range.black);  // rounds and clips
  } else {
    picture.copyTo(target);
  }
  return image;
}

Image ReadImageFile(const std::filesystem::path& file) { return ToColour(ReadGreyOrColour(file)); }

Image ToColour(const Image& image) {
  if (image.channels == 3) return image;
  Image colour(image.width_px, image.height_px, 3);
  std::uint8_t* to = colour.data.data();
  for (const std::uint8_t grey : image.data) to = std::fill_n(to, 3, grey);
  return colour;
}

void WritePng(const std::filesystem::path& file, const Image& image) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  bool written = false;
  try {
    written = cv::imwrite(file.string(), View(image));
  } catch (const cv::Exception&) {  // reported below
  }
  if (!written) throw WorkError(fmt::format("{}: cannot be written", file.string()));
}

std::string EncodeJpeg(const Image& image, int quality, int most_width_px) {
  std::vector<std::uint8_t> bytes;
  try {
    cv::Mat picture = View(image);
    if (image.width_px > most_width_px) {
      const double scale = double(most_width_px) / image.width_px;
      cv::Mat smaller;
      cv::resize(picture, smaller, cv::Size(), scale, scale, cv::INTER_AREA);
      picture = smaller;
    }
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  } catch (const cv::Exception&) {  // reported below
  }
  if (bytes.empty()) throw WorkError("a picture cannot be written as JPEG");
  return {bytes.begin(), bytes.end()};
}

namespace {

struct Codec {
  char code[5];
  bool plays_in_browsers;
};

/// Those of MP4 files, the one that most browsers play first.
constexpr Codec kCodecs[] = {{"avc1", true}, {"vp09", true}, {"mp4v", false}};

}  // namespace

struct VideoFile::Impl {
  std::filesystem::path file;
  double rate_hz;
  cv::VideoWriter writer;
  bool plays_in_browsers = true;

  bool Open(cv::Size size) {
    const QuietStderr quiet;
    for (const auto& [code, plays] : kCodecs) {
      const int fourcc = cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]);
      plays_in_browsers = plays;
      if (writer.open(file.string(), fourcc, rate_hz, size)) return true;
    }
    return false;
  }
};

VideoFile::VideoFile(const std::filesystem::path& file, double rate_hz)
    : impl_(std::make_unique<Impl>(Impl{file, rate_hz, {}, true})) {}
VideoFile::~VideoFile() = default;

void VideoFile::Add(const Image& image) {
  if (!impl_->writer.isOpened()) {
    if (!impl_->Open({image.width_px, image.height_px})) {
      throw WorkError(fmt::format("{}: the video cannot be written", impl_->file.string()));
    }
  }
  impl_->writer.write(View(image));
}

bool VideoFile::PlaysInBrowsers() const { return impl_->plays_in_browsers; }

void VideoFile::Finish() {
  impl_->writer.release();
  std::error_code error;
  if (std::filesystem::file_size(impl_->file, error) == 0 || error) {
    throw WorkError(fmt::format("{}: the video cannot be written", impl_->file.string()));
  }
}

}  // namespace flextip
