#include "recording/frames/frame_source.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/videoio.hpp>
#include <thread>
#include <utility>

#include "core/error.h"
#include "recording/frames/video_info.h"
#include "recording/frames/video_reader.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kMostFrames = 1e9;

Image FromMat(const cv::Mat& picture) {
  Image image(picture.cols, picture.rows, picture.channels());
  const auto row_bytes = static_cast<std::size_t>(image.channels) * picture.cols;
  for (int y = 0; y < picture.rows; ++y) {
    std::copy_n(picture.ptr<std::uint8_t>(y), row_bytes, image.Row(y));
  }
  return image;
}

void CheckSize(const std::string& what, const Image& image, const CameraCalibration& camera) {
  if (image.width_px == camera.width_px && image.height_px == camera.height_px) return;
  throw InputError::At(what, 0,
                       fmt::format("is {} x {}, expected the camera's {} x {}", image.width_px,
                                   image.height_px, camera.width_px, camera.height_px));
}

/// Returns the rate that the file states; the camera's where it states none that can be.
double RateOf(const VideoReader& video, const CameraCalibration& camera) {
  const double own_hz = PossibleRate(video.StatedRate());
  return own_hz > 0 ? own_hz : camera.rate_hz;
}

class PictureFrames : public FrameSource {
 public:
  PictureFrames(fs::path folder, Series<std::string> names, const CameraCalibration& camera,
                const GreyRange& range)
      : folder_(std::move(folder)), names_(std::move(names)), camera_(camera), range_(range) {}

  std::size_t Count() const override { return names_.size(); }
  void Skip(std::size_t frames) override { next_ += frames; }
  std::optional<Frame> Next() override {
    if (next_ >= names_.size()) return {};
    const auto& [t_ns, name] = names_[next_++];
    const fs::path file = folder_ / name;
    Frame frame{t_ns, ReadGreyOrColour(file, range_)};
    CheckSize(file.string(), frame.image, camera_);
    return frame;
  }

 private:
  fs::path folder_;
  Series<std::string> names_;
  CameraCalibration camera_;
  GreyRange range_;
  std::size_t next_ = 0;
};

/// All frames of a video, by a rate, or those of `numbers`.
class VideoFrames : public FrameSource {
 public:
  VideoFrames(const fs::path& file, const CameraCalibration& camera, Series<int> numbers)
      : file_(file.string()),
        camera_(camera),
        numbers_(std::move(numbers)),
        video_(VideoReader::Open(file_)) {
    if (!video_) throw InputError::At(file_, 0, "the video cannot be opened");
  }

  double OwnRate() const { return RateOf(*video_, camera_); }
  void SetRate(double rate_hz) { rate_hz_ = rate_hz; }

  std::size_t Count() const override {
    if (!numbers_.empty()) return numbers_.size();
    // Made of the duration that the file states, which may be anything.
    return static_cast<std::size_t>(std::min(kMostFrames, video_->StatedFrames()));
  }
  void Skip(std::size_t frames) override { next_ += frames; }
  std::optional<Frame> Next() override {
    if (!numbers_.empty() && next_ >= numbers_.size()) return {};
    const std::size_t wanted =
        numbers_.empty() ? next_ : static_cast<std::size_t>(numbers_[next_].value);
    for (; position_ <= wanted; ++position_) {
      if (!video_->Advance()) return {};
    }
    auto picture = video_->Picture();
    if (!picture) return {};
    const TimeNs t_ns = numbers_.empty() ? std::llround(1e9 * static_cast<double>(next_) / rate_hz_)
                                         : numbers_[next_].t_ns;
    ++next_;
    Frame frame{t_ns, std::move(*picture)};
    CheckSize(file_, frame.image, camera_);
    return frame;
  }

 private:
  std::string file_;
  CameraCalibration camera_;
  Series<int> numbers_;
  std::unique_ptr<VideoReader> video_;
  double rate_hz_ = 30.0;
  std::size_t next_ = 0, position_ = 0;  // the next frame to give, and the one the video gives next
};

class LiveFrames : public FrameSource {
 public:
  LiveFrames(const std::string& source, const CameraCalibration& camera)
      : source_(source), camera_(camera) {
    const bool device = std::all_of(source.begin(), source.end(),
                                    [](unsigned char c) { return c >= '0' && c <= '9'; });
    if (source.empty() || !(device ? OpenDevice() : OpenVideo())) {
      throw InputError(fmt::format("live source {}: cannot be opened", Quoted(source)));
    }
  }

  std::size_t Count() const override { return 0; }
  void Skip(std::size_t frames) override {
    for (std::size_t i = 0; i < frames; ++i) (void)Grab();
  }
  std::optional<Frame> Next() override {
    AwaitTurn();
    if (!Grab()) return {};
    using std::chrono::nanoseconds;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    // A clock that was set back must not turn time around.
    last_ns_ = std::max(last_ns_ + 1, std::chrono::duration_cast<nanoseconds>(now).count());
    auto picture = Retrieve();
    if (!picture) return {};
    Frame frame{last_ns_, std::move(*picture)};
    CheckSize(source_, frame.image, camera_);
    return frame;
  }

 private:
  /// A file gives its frames at its own rate, as a camera would.
  void AwaitTurn() {
    if (period_.count() == 0) return;
    std::this_thread::sleep_until(next_);
    const auto now = std::chrono::steady_clock::now();
    const bool keeps_up = now - next_ < period_;  // not so at the first frame
    next_ = (keeps_up ? next_ : now) + period_;
  }

  bool Grab() { return video_ ? video_->Advance() : device_.grab(); }

  std::optional<Image> Retrieve() {
    if (video_) return video_->Picture();
    cv::Mat picture;
    if (!device_.retrieve(picture) || picture.empty()) return {};
    return FromMat(picture);
  }

  bool OpenVideo() {
    std::error_code error;
    const bool file = fs::is_regular_file(source_, error);
    video_ =
        VideoReader::Open(source_, file ? VideoReader::Kind::kFile : VideoReader::Kind::kStream);
    if (video_ && file)
      period_ = std::chrono::nanoseconds(std::llround(1e9 / RateOf(*video_, camera_)));
    return video_ != nullptr;
  }

  bool OpenDevice() {
    const auto number = ParseInteger(source_);
    if (!number || *number > 1000) return false;
    const QuietStderr quiet;
    try {
      if (!device_.open(static_cast<int>(*number))) return false;
    } catch (const cv::Exception&) {
      return false;
    }
    // A device gives its own size unless asked; the newest frame counts, not a queue of old ones.
    device_.set(cv::CAP_PROP_FRAME_WIDTH, camera_.width_px);
    device_.set(cv::CAP_PROP_FRAME_HEIGHT, camera_.height_px);
    device_.set(cv::CAP_PROP_BUFFERSIZE, 1);
    return true;
  }

  std::string source_;
  CameraCalibration camera_;
  std::unique_ptr<VideoReader> video_;  // or, where the source is a number:
  cv::VideoCapture device_;
  TimeNs last_ns_ = 0;
  std::chrono::nanoseconds period_{0};  // 0: the source has a pace of its own
  std::chrono::steady_clock::time_point next_{};
};

bool IsPicture(const fs::path& file) {
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  });
  for (const char* known : {".png", ".jpg", ".jpeg", ".tif", ".tiff"}) {
    if (kind == known) return true;
  }
  return false;
}

/// frame_2 before frame_10: runs of digits compare as numbers.
bool NaturallyBefore(const std::string& a, const std::string& b) {
  const auto digits = [](const std::string& s, std::size_t from) {
    const auto end = s.find_first_not_of("0123456789", from);
    const std::string run = s.substr(from, end - from);
    const auto start = run.find_first_not_of('0');
    return std::pair(run.size(), start == std::string::npos ? "" : run.substr(start));
  };
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const auto [length_a, number_a] = digits(a, i);
    const auto [length_b, number_b] = digits(b, j);
    if (length_a > 0 && length_b > 0) {
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
      i += length_a, j += length_b;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i, ++j;
    }
  }
  return std::pair(a.size(), a) < std::pair(b.size(), b);
}

std::vector<std::string> PictureNames(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && IsPicture(entry.path())) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end(), NaturallyBefore);
  return names;
}

/// Every name as a number of nanoseconds, where that can be meant.
std::vector<TimeNs> TimesOfNames(const std::vector<std::string>& names) {
  constexpr TimeNs kShortest_ns = 100'000;
  std::vector<TimeNs> times;
  for (const auto& name : names) {
    const auto time = ParseInteger(fs::path(name).stem().string());
    if (!time || (!times.empty() && *time - times.back() < kShortest_ns)) return {};
    times.push_back(*time);
  }
  return times.size() > 1 ? times : std::vector<TimeNs>{};
}

}  // namespace

std::vector<fs::path> PictureFiles(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    const std::vector<std::string> names = PictureNames(path);
    if (names.empty()) {
      throw InputError::At(path.string(), 0, "no PNG, JPEG or TIFF files, expected pictures");
    }
    for (const std::string& name : names) files.push_back(path / name);
  }
  return files;
}

Series<std::string> PicturesInFolder(const fs::path& folder, double rate_hz,
                                     bool times_from_names) {
  const std::vector<std::string> names = PictureNames(folder);
  const auto times = times_from_names ? TimesOfNames(names) : std::vector<TimeNs>{};
  Series<std::string> pictures;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const TimeNs by_rate = std::llround(1e9 * static_cast<double>(i) / rate_hz);
    pictures.push_back({times.empty() ? by_rate : times[i], names[i]});
  }
  return pictures;
}

std::unique_ptr<FrameSource> OpenRecordedFrames(const fs::path& recording, const std::string& name,
                                                const CameraStream& camera,
                                                const GreyRange& range) {
  const fs::path folder = recording / name;
  if (!camera.video.empty() && !camera.frame_numbers.empty()) {
    return std::make_unique<VideoFrames>(folder / camera.video, camera.calibration,
                                         camera.frame_numbers);
  }
  if (camera.filenames.empty()) {
    throw InputError::At(folder.string(), 0, "no frames, only the camera's settings");
  }
  return std::make_unique<PictureFrames>(folder / "data", camera.filenames, camera.calibration,
                                         range);
}

std::unique_ptr<FrameSource> OpenPlainFrames(const fs::path& source,
                                             const CameraCalibration& camera,
                                             const std::optional<double>& rate_hz,
                                             const GreyRange& range) {
  std::error_code error;
  if (fs::is_directory(source, error)) {
    auto pictures = PicturesInFolder(source, rate_hz.value_or(camera.rate_hz), !rate_hz);
    if (pictures.empty()) {
      throw InputError::At(source.string(), 0, "no PNG, JPEG or TIFF files, expected frames");
    }
    return std::make_unique<PictureFrames>(source, std::move(pictures), camera, range);
  }
  if (!fs::is_regular_file(source, error)) {
    throw InputError::At(source.string(), 0,
                         "no such folder or file, expected a recording, pictures or a video");
  }
  auto video = std::make_unique<VideoFrames>(source, camera, Series<int>{});
  video->SetRate(rate_hz.value_or(video->OwnRate()));
  return video;
}

std::unique_ptr<FrameSource> OpenLiveFrames(const std::string& source,
                                            const CameraCalibration& camera) {
  return std::make_unique<LiveFrames>(source, camera);
}

}  // namespace flextip
