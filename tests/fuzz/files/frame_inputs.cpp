// Pictures, videos and the times beside a video.
#include "exchange/formats/side_car.h"
#include "recording/frames/frame_source.h"
#include "recording/frames/frames.h"
#include "recording/frames/image_head.h"
#include "recording/frames/video_info.h"
#include "recording/frames/video_reader.h"
#include "recording/text/bounds.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

void RequireWhole(const Image& image) {
  Require(image.width_px > 0 && image.height_px > 0);
  Require(double(image.width_px) * image.height_px <= kMostPixels);
  Require(image.channels == 1 || image.channels == 3);
  Require(image.data.size() == std::size_t(image.width_px) * image.height_px * image.channels);
}

}  // namespace

int CheckImageInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("image", TextOf(input));
  const ImageHead head = ReadImageHead(file);
  Require(!head.problem.empty() || (head.width_px > 0 && head.height_px > 0));
  Image image;
  if (!ReadsOrRefuses([&] { image = ReadGreyOrColour(file); })) return 0;
  RequireWhole(image);
  Require(head.problem.empty());
  Require(head.width_px == image.width_px && head.height_px == image.height_px);
  return 1;
}

int CheckVideoInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  static const bool silent = (SilenceVideoCodecs(), true);
  Require(silent);
  const auto file = folder.Write("video.mp4", TextOf(input));
  VideoInfo info;
  bool is_small = false;
  const bool read = ReadsOrRefuses([&] {
    // A few bytes may stand for many large pictures, which take their time and show nothing more.
    constexpr double kLargest = 1e5;
    const auto video = VideoReader::Open(file.string(), VideoReader::Kind::kFile, kLargest);
    is_small = video && double(video->Width_px()) * video->Height_px() <= kLargest;
    if (is_small) info = ReadVideoInfo(file);
  });
  if (!read || !is_small) return 0;
  Require(info.width_px > 0 && info.height_px > 0 && info.frames > 0);
  CameraCalibration camera;
  camera.width_px = info.width_px;
  camera.height_px = info.height_px;
  camera.rate_hz = 30.0;
  ReadsOrRefuses([&] {
    const auto frames = OpenPlainFrames(file, camera, {});
    TimeNs last = -1;
    for (int i = 0; i < 20; ++i) {
      const auto frame = frames->Next();
      if (!frame) break;
      Require(frame->t_ns > last);
      last = frame->t_ns;
      RequireWhole(frame->image);
    }
  });
  return 1;
}

int CheckSideCarInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("video.json", TextOf(input));
  exchange::SideCar side_car;
  if (!ReadsOrRefuses([&] { side_car = exchange::ReadSideCar(file); })) return 0;
  Require(!side_car.t_ns.empty());
  for (std::size_t i = 1; i < side_car.t_ns.size(); ++i)
    Require(side_car.t_ns[i] > side_car.t_ns[i - 1]);
  return 1;
}

}  // namespace flextip
