#include "exchange/bags/pictures.h"

#include <fmt/format.h>

#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

/// How the bytes of an encoding become a picture in grey or blue, green, red.
struct Encoding {
  int type;        ///< of the matrix that the bytes are
  int conversion;  ///< of cv::cvtColor; -1: none
};

// OpenCV names a Bayer pattern by the second row's second and third pixel.
const std::map<std::string, Encoding>& Encodings() {
  static const std::map<std::string, Encoding> encodings{
      {"mono8", {CV_8UC1, -1}},
      {"8UC1", {CV_8UC1, -1}},
      {"mono16", {CV_16UC1, -1}},
      {"16UC1", {CV_16UC1, -1}},
      {"bgr8", {CV_8UC3, -1}},
      {"8UC3", {CV_8UC3, -1}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUYV}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUYV}}};
  return encodings;
}

bool IsJpeg(Bytes data) { return data.size() > 2 && data[0] == 0xFF && data[1] == 0xD8; }
bool IsPng(Bytes data) { return data.size() > 8 && data[0] == 0x89 && data[1] == 'P'; }
bool IsPacked(const ImageMessage& message) { return message.width_px == 0; }

cv::Mat PictureOf(const std::filesystem::path& file, const ImageMessage& message) {
  const auto refuse = [&](const std::string& what) {
    throw InputError::At(file.filename().string(), 0, what);
  };
  const auto found = Encodings().find(message.encoding);
  if (found == Encodings().end()) {
    refuse(
        fmt::format("found the encoding {}, expected mono8, mono16, bgr8, rgb8, bgra8, rgba8, "
                    "bayer_*8 or yuv422",
                    Quoted(message.encoding)));
  }
  const Encoding& encoding = found->second;
  if (encoding.type == CV_8UC2 && message.width_px % 2 != 0) {  // two pixels share their colour
    refuse(fmt::format("found {} pixels in a line of {}, expected an even number", message.width_px,
                       message.encoding));
  }
  const auto pixel = static_cast<std::size_t>(CV_ELEM_SIZE(encoding.type));
  if (message.width_px < 1 || message.height_px < 1) {
    refuse(fmt::format("found a picture of {} x {} pixels", message.width_px, message.height_px));
  }
  const auto lines = static_cast<std::size_t>(message.height_px);
  if (message.step < pixel * static_cast<std::size_t>(message.width_px) ||
      message.data.size() < message.step * lines) {
    refuse(fmt::format("found {} bytes, expected {} x {} pixels of {}", message.data.size(),
                       message.width_px, message.height_px, message.encoding));
  }
  if (message.big_endian && pixel == 2 && encoding.conversion < 0) {
    refuse("found big-endian pixels, expected little-endian");
  }
  const cv::Mat picture(message.height_px, message.width_px, encoding.type,
                        const_cast<std::uint8_t*>(message.data.data()), message.step);
  if (encoding.conversion < 0) return picture;
  cv::Mat converted;
  cv::cvtColor(picture, converted, encoding.conversion);
  return converted;
}

}  // namespace

std::string PictureSuffix(const ImageMessage& message) {
  return IsPacked(message) && IsJpeg(message.data) ? ".jpg" : ".png";
}

void WritePicture(const std::filesystem::path& file, const ImageMessage& message) {
  if (IsPacked(message)) {
    if (!IsJpeg(message.data) && !IsPng(message.data)) {
      throw InputError::At(file.filename().string(), 0,
                           fmt::format("found a compressed picture of format {}, expected jpeg or "
                                       "png",
                                       Quoted(message.encoding)));
    }
    WriteTextFile(file, std::string(message.data.begin(), message.data.end()));
    return;
  }
  std::vector<std::uint8_t> packed;
  try {
    cv::imencode(".png", PictureOf(file, message), packed, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception&) {
    throw InputError::At(file.filename().string(), 0,
                         fmt::format("found {} x {} pixels of {}: cannot be made a picture",
                                     message.width_px, message.height_px, message.encoding));
  }
  WriteTextFile(file, std::string(packed.begin(), packed.end()));
}

}  // namespace flextip::exchange
