#include "apps/simulate/frame_files.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace flextip {
namespace {

void SaveImage(const std::filesystem::path& file, const Image& image, const std::vector<int>& how) {
  const int type = image.channels == 3 ? CV_8UC3 : CV_8UC1;
  const cv::Mat frame(image.height_px, image.width_px, type,
                      const_cast<std::uint8_t*>(image.data.data()));  // only read
  if (!cv::imwrite(file.string(), frame, how)) {
    throw WorkError(file.string() + ": cannot be written");
  }
}

}  // namespace

FrameFiles::FrameFiles(const std::filesystem::path& folder, bool keep)
    : folder_(folder), keep_(keep) {
  std::filesystem::create_directories(keep ? folder / "cam0" / "data" : folder);
}

void FrameFiles::Add(TimeNs t_ns, const Image& image) {
  last_ = image;
  // Noise repeats nothing: codes by frequency alone are smaller here than repeats, and fast.
  const std::vector<int> how{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                             cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY};
  if (keep_) SaveImage(folder_ / "cam0" / "data" / fmt::format("{}.png", t_ns), image, how);
}

void FrameFiles::Finish(Recording& recording) const {
  if (!last_.Empty()) SaveImage(folder_ / "last_frame.jpg", last_, {cv::IMWRITE_JPEG_QUALITY, 85});
  if (!keep_) recording.cam0->filenames.clear();
}

}  // namespace flextip
