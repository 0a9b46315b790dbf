#include "recording/frames/video_info.h"

#include <cmath>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>
#include <system_error>

#include "core/error.h"
#include "recording/frames/frames.h"

namespace flextip {

VideoInfo ReadVideoInfo(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError::At(file.string(), 0, "no such file, expected a video");
  }
  const QuietStderr quiet;
  cv::VideoCapture video;
  try {
    const bool ffmpeg = cv::videoio_registry::hasBackend(cv::CAP_FFMPEG);
    video.open(file.string(), ffmpeg ? cv::CAP_FFMPEG : cv::CAP_ANY);
  } catch (const cv::Exception&) {
    video.release();
  }
  VideoInfo info;
  if (video.isOpened()) {
    info.width_px = static_cast<int>(video.get(cv::CAP_PROP_FRAME_WIDTH));
    info.height_px = static_cast<int>(video.get(cv::CAP_PROP_FRAME_HEIGHT));
    const double rate_hz = video.get(cv::CAP_PROP_FPS);
    info.rate_hz = std::isfinite(rate_hz) && rate_hz > 0 ? rate_hz : 0.0;
    while (video.grab()) ++info.frames;
  }
  if (info.frames == 0) {
    throw InputError::At(file.string(), 0, "is not a video that can be read");
  }
  return info;
}

}  // namespace flextip
