#include "apps/frames.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "core/error.h"
#include "recording/image_head.h"

namespace flextip {
namespace {

Image FromMat(const cv::Mat& bgr) {
  Image image(bgr.cols, bgr.rows, 3);
  for (int y = 0; y < bgr.rows; ++y) {
    std::copy_n(bgr.ptr<std::uint8_t>(y), static_cast<std::size_t>(3) * bgr.cols, image.Row(y));
  }
  return image;
}

cv::Mat View(const Image& image) {
  return cv::Mat(image.height_px, image.width_px, image.channels == 3 ? CV_8UC3 : CV_8UC1,
                 const_cast<std::uint8_t*>(image.data.data()));  // only read
}

// The codecs write what they dislike straight to stderr; whoever called them says it in one line.
class QuietStderr {
 public:
  QuietStderr() : saved_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nothing = open("/dev/null", O_WRONLY);
    if (saved_ >= 0 && nothing >= 0) dup2(nothing, STDERR_FILENO);
    if (nothing >= 0) close(nothing);
  }
  ~QuietStderr() {
    if (saved_ < 0) return;
    dup2(saved_, STDERR_FILENO);
    close(saved_);
  }
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int saved_;
};

}  // namespace

void SilenceVideoCodecs() { setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0); }

Image ReadImageFile(const std::filesystem::path& file) {
  const ImageHead head = ReadImageHead(file);
  if (!head.problem.empty()) {
    throw InputError::At(file.string(), 0, fmt::format("the image {}", head.problem));
  }
  cv::Mat bgr;
  try {
    const QuietStderr quiet;
    bgr = cv::imread(file.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // reported below
  }
  if (bgr.empty()) throw InputError::At(file.string(), 0, "the image cannot be decoded");
  return FromMat(bgr);
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

struct FrameReader::Impl {
  std::filesystem::path folder;  // RECORDING/cam0
  CameraStream camera;
  std::size_t next = 0;
  cv::VideoCapture video;
  int video_position = 0;  // the number of the frame that the video gives next

  std::optional<Frame> NextOfVideo();
};

FrameReader::FrameReader(const std::filesystem::path& recording, const CameraStream& camera)
    : impl_(std::make_unique<Impl>()) {
  impl_->folder = recording / "cam0";
  impl_->camera = camera;
  if (Count() == 0) {
    throw InputError::At(impl_->folder.string(), 0, "no frames, only the camera's settings");
  }
  if (camera.video.empty()) return;
  const auto file = impl_->folder / camera.video;
  if (!impl_->video.open(file.string())) {
    throw InputError::At(file.string(), 0, "the video cannot be opened");
  }
}

FrameReader::~FrameReader() = default;

std::size_t FrameReader::Count() const {
  const CameraStream& c = impl_->camera;
  return c.video.empty() ? c.filenames.size() : c.frame_numbers.size();
}

std::optional<Frame> FrameReader::Impl::NextOfVideo() {
  const Sample<int>& wanted = camera.frame_numbers[next];
  while (video_position < wanted.value) {
    if (!video.grab()) return {};
    ++video_position;
  }
  cv::Mat bgr;
  if (!video.read(bgr) || bgr.empty()) return {};
  ++video_position;
  return Frame{wanted.t_ns, FromMat(bgr)};
}

std::optional<Frame> FrameReader::Next() {
  if (impl_->next >= Count()) return {};
  std::optional<Frame> frame;
  if (impl_->camera.video.empty()) {
    const Sample<std::string>& name = impl_->camera.filenames[impl_->next];
    frame = Frame{name.t_ns, ReadImageFile(impl_->folder / "data" / name.value)};
  } else {
    frame = impl_->NextOfVideo();
  }
  ++impl_->next;
  return frame;
}

struct VideoFile::Impl {
  std::filesystem::path file;
  double rate_hz;
  cv::VideoWriter writer;
};

VideoFile::VideoFile(const std::filesystem::path& file, double rate_hz)
    : impl_(std::make_unique<Impl>(Impl{file, rate_hz, {}})) {}
VideoFile::~VideoFile() = default;

void VideoFile::Add(const Image& image) {
  if (!impl_->writer.isOpened()) {
    const int code = cv::VideoWriter::fourcc('m', 'p', '4', 'v');
    const cv::Size size(image.width_px, image.height_px);
    if (!impl_->writer.open(impl_->file.string(), code, impl_->rate_hz, size)) {
      throw WorkError(fmt::format("{}: the video cannot be written", impl_->file.string()));
    }
  }
  impl_->writer.write(View(image));
}

void VideoFile::Finish() {
  impl_->writer.release();
  std::error_code error;
  if (std::filesystem::file_size(impl_->file, error) == 0 || error) {
    throw WorkError(fmt::format("{}: the video cannot be written", impl_->file.string()));
  }
}

}  // namespace flextip
