#include "recording/frames/image_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <system_error>

#include "recording/frames/frames.h"
#include "recording/frames/stated_size.h"
#include "recording/text/bounds.h"

namespace flextip {
namespace {

using namespace std::string_view_literals;

constexpr auto kPngStart = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"sv;
constexpr auto kPngEnd = "\0\0\0\0IEND\xae\x42\x60\x82"sv;
constexpr auto kJpegStart = "\xff\xd8\xff"sv;
constexpr auto kJpegEnd = "\xff\xd9"sv;
constexpr std::streamoff kTail = 4096;  // some writers append notes after the image's end

std::int64_t BigEndian(std::string_view bytes) {
  std::int64_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

ImageHead Bounded(std::int64_t width_px, std::int64_t height_px) {
  if (width_px < 1 || height_px < 1) return {0, 0, "is damaged"};
  if (double(width_px) * double(height_px) > kMostPixels) {
    return {
        0, 0,
        fmt::format("is {} x {}, expected at most {:g} pixels", width_px, height_px, kMostPixels)};
  }
  return {static_cast<int>(width_px), static_cast<int>(height_px), ""};
}

// Walks over the marker segments to the frame header (ITU-T T.81, B.2.2): its marker is one of
// 0xC0..0xCF but for tables (C4, CC) and the reserved C8.
ImageHead JpegHead(std::ifstream& in) {
  std::streamoff at = 2;
  for (;;) {
    const std::string head = ReadBytes(in, at, 9);
    if (head.size() < 9) return {0, 0, "is cut off"};
    if (head[0] != '\xff') return {0, 0, "is damaged"};
    const std::int64_t marker = BigEndian(head.substr(1, 1));
    if (marker == 0xff) {  // a fill byte
      ++at;
      continue;
    }
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      return Bounded(BigEndian(head.substr(7, 2)), BigEndian(head.substr(5, 2)));
    }
    at += 2 + BigEndian(head.substr(2, 2));
  }
}

ImageHead DecodedHead(const std::filesystem::path& file) {
  const ImageHead unknown{0, 0, "is not an image that can be read"};
  const auto stated = ReadStatedSize(file);
  if (!stated) return unknown;
  const ImageHead head = Bounded(stated->width_px, stated->height_px);
  if (!head.problem.empty()) return head;
  cv::Mat image;
  try {
    const QuietStderr quiet;
    image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) return unknown;
  return {image.cols, image.rows, ""};
}

}  // namespace

ImageHead ReadImageHead(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {0, 0, "is missing"};
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file, error));
  if (error) return {0, 0, "cannot be read"};
  if (size == 0) return {0, 0, "is empty"};
  std::ifstream in(file, std::ios::binary);
  if (!in) return {0, 0, "cannot be read"};

  const std::string start = ReadBytes(in, 0, 24);
  const bool png = start.starts_with(kPngStart.substr(0, 8));
  const bool jpeg = start.starts_with(kJpegStart);
  if (!png && !jpeg) return DecodedHead(file);
  const std::string tail = ReadBytes(in, std::max<std::streamoff>(0, size - kTail), kTail);
  if (tail.find(png ? kPngEnd : kJpegEnd) == std::string::npos) return {0, 0, "is cut off"};
  if (jpeg) return JpegHead(in);
  if (!start.starts_with(kPngStart) || start.size() < 24) return {0, 0, "is damaged"};
  return Bounded(BigEndian(start.substr(16, 4)), BigEndian(start.substr(20, 4)));
}

}  // namespace flextip
