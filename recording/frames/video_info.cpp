#include "recording/frames/video_info.h"

#include <array>
#include <fstream>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "recording/frames/video_reader.h"
#include "recording/text/bounds.h"

namespace flextip {

using namespace std::string_view_literals;

bool IsVideo(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 512> bytes{};
  in.read(bytes.data(), bytes.size());
  const std::string_view head(bytes.data(), static_cast<std::size_t>(in.gcount()));
  const auto starts = [&](std::string_view with) { return head.starts_with(with); };
  const auto holds = [&](std::size_t at, std::string_view what) {
    return head.size() >= at + what.size() && head.substr(at, what.size()) == what;
  };
  // MP4 and QuickTime begin with a box, whose name follows its size.
  for (const auto box : {"ftyp"sv, "moov"sv, "mdat"sv, "free"sv, "skip"sv, "wide"sv}) {
    if (holds(4, box)) return true;
  }
  if (starts("RIFF"sv)) return holds(8, "AVI"sv);
  if (starts("G"sv)) return holds(188, "G"sv);  // packets of a transport stream
  // Matroska and WebM, Ogg, Flash, ASF, MXF, MPEG streams, uncompressed frames.
  for (const auto start : {"\x1a\x45\xdf\xa3"sv, "OggS"sv, "FLV\x01"sv, "\x30\x26\xb2\x75"sv,
                           "\x06\x0e\x2b\x34"sv, "\0\0\x01"sv, "\0\0\0\x01"sv, "YUV4MPEG2"sv}) {
    if (starts(start)) return true;
  }
  return false;
}

double PossibleRate(double stated_hz) {
  const Bounds bounds = BoundsOf("rate_hz");
  return stated_hz >= bounds.least && stated_hz <= bounds.most ? stated_hz : 0.0;
}

void RefuseHugeVideo(const std::string& file, double width_px, double height_px) {
  if (width_px * height_px <= kMostPixels) return;
  throw InputError::At(
      file, 0,
      fmt::format("is {} x {}, expected at most {:g} pixels", width_px, height_px, kMostPixels));
}

VideoInfo ReadVideoInfo(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError::At(file.string(), 0, "no such file, expected a video");
  }
  VideoInfo info;
  if (const auto video = VideoReader::Open(file.string())) {
    info.width_px = video->Width_px();
    info.height_px = video->Height_px();
    info.rate_hz = PossibleRate(video->StatedRate());
    while (video->Advance()) ++info.frames;
  }
  if (info.frames == 0) {
    throw InputError::At(file.string(), 0, "is not a video that can be read");
  }
  return info;
}

}  // namespace flextip
