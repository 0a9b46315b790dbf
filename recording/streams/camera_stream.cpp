// cam0 and cam1: the calibration, and which frame was taken when.
#include <algorithm>
#include <cmath>
#include <system_error>

#include "core/median.h"
#include "recording/cameras/yaml.h"
#include "recording/frames/image_head.h"
#include "recording/frames/video_reader.h"
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

void CheckImage(const CsvReader& csv, const std::filesystem::path& file,
                const CameraCalibration& camera) {
  const ImageHead image = ReadImageHead(file);
  if (!image.problem.empty()) {
    throw csv.Error(fmt::format("the frame {} {}", file.string(), image.problem));
  }
  if (image.width_px != camera.width_px || image.height_px != camera.height_px) {
    throw csv.Error(fmt::format("the frame {} is {} x {}, expected {} x {}", file.string(),
                                image.width_px, image.height_px, camera.width_px,
                                camera.height_px));
  }
}

std::string ReadFilename(const CsvReader& csv) {
  const std::string name(csv.Text(1));
  if (name.find('/') != std::string::npos || name == "..") {
    throw csv.Error(fmt::format("found {}, expected the name of a file in data/", Quoted(name)));
  }
  return name;
}

// A frame whose interval to the one before is about n usual intervals left out n - 1 frames. The
// median is the usual one: it stands whatever a few gaps are.
template <class T>
void CountGaps(const std::filesystem::path& file, const Series<T>& frames, ReadLog& log) {
  if (frames.size() < 3) return;
  std::vector<TimeNs> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    intervals.push_back(frames[i].t_ns - frames[i - 1].t_ns);
  }
  const TimeNs period = Median(intervals);
  long dropped = 0;
  TimeNs first = 0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double periods = static_cast<double>(intervals[i]) / static_cast<double>(period);
    if (periods <= 1.5) continue;
    if (dropped == 0) first = frames[i].t_ns;
    dropped += std::lround(periods) - 1;
  }
  if (dropped == 0) return;
  log.dropped_frames += dropped;
  log.warnings.push_back(
      fmt::format("{}: about {} frames dropped (gaps in time), the first after {}", file.string(),
                  dropped, first));
}

// A row without a file name is the recorder's own note of a dropped frame.
void SkipUnnamed(const std::filesystem::path& file, Series<std::string>& frames, ReadLog& log) {
  const auto count =
      std::erase_if(frames, [](const Sample<std::string>& frame) { return frame.value.empty(); });
  if (frames.empty()) throw InputError::At(file.string(), 2, "no row names a frame");
  if (count == 0) return;
  log.dropped_frames += static_cast<long>(count);
  log.warnings.push_back(
      fmt::format("{}: skipped {} dropped frames (rows without a filename)", file.string(), count));
}

void ReadImages(const std::filesystem::path& folder, bool check, CameraStream& stream,
                ReadLog& log) {
  const auto file = folder / "data.csv";
  stream.filenames = ReadSeries<std::string>(file, {"filename"}, log, [&](const CsvReader& csv) {
    std::string name = ReadFilename(csv);
    if (check && !name.empty()) CheckImage(csv, folder / "data" / name, stream.calibration);
    return name;
  });
  CountGaps(file, stream.filenames, log);
  SkipUnnamed(file, stream.filenames, log);
}

// Containers state how many frames they hold by their duration, which may be off; they are counted
// only where that says that frames are missing.
long CountFrames(VideoReader& video, long needed) {
  if (video.StatedFrames() >= static_cast<double>(needed)) return needed;
  long count = 0;
  while (count < needed && video.Advance()) ++count;
  return count;
}

// The number of frames that `video` can be said to hold of the `needed` ones.
long CheckVideo(const YamlMap& yaml, const std::filesystem::path& file,
                const CameraCalibration& camera, long needed) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw yaml.Error("video", fmt::format("{} is missing", file.string()));
  }
  const auto video = VideoReader::Open(file.string());
  if (!video) {
    throw yaml.Error("video", fmt::format("{} is not a video that can be read", file.string()));
  }
  if (video->Width_px() != camera.width_px || video->Height_px() != camera.height_px) {
    throw yaml.Error(
        "video", fmt::format("{} is {} x {}, expected {} x {}", file.string(), video->Width_px(),
                             video->Height_px(), camera.width_px, camera.height_px));
  }
  return CountFrames(*video, needed);
}

void ReadVideo(const std::filesystem::path& folder, const YamlMap& yaml, bool check,
               CameraStream& stream, ReadLog& log) {
  const auto file = folder / "data.csv";
  TimeNs last = -1;
  long last_line = 0;
  stream.frame_numbers = ReadSeries<int>(file, {"frame []"}, log, [&](const CsvReader& csv) {
    const TimeNs number = csv.Integer(1);
    if (number <= last || number > 100'000'000) {
      throw csv.Error(fmt::format("found frame {}, expected more than {}", number, last));
    }
    last = number;
    last_line = csv.line();
    return static_cast<int>(number);
  });
  CountGaps(file, stream.frame_numbers, log);
  if (!check) return;
  const long frames = CheckVideo(yaml, folder / stream.video, stream.calibration, last + 1);
  if (frames > last) return;
  throw InputError::At(file.string(), last_line,
                       fmt::format("frame {} is missing: {} holds {} frames", last,
                                   (folder / stream.video).string(), frames));
}

bool HoldsFiles(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder) && !std::filesystem::is_empty(folder);
}

}  // namespace

CameraStream ReadCamera(const std::filesystem::path& folder, bool check_frames, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  CameraStream stream;
  stream.comment = ReadHead(yaml).comment;
  stream.calibration = ReadCalibrationKeys(yaml);
  stream.has_T_RC = StatesPose(yaml);
  if (!stream.has_T_RC) (void)yaml.Text("T_RC");  // a recording says that it is unknown
  stream.video = yaml.TextOr("video", "");
  yaml.WarnUnknown(log);
  if (!std::filesystem::exists(folder / "data.csv")) {
    if (stream.video.empty() && !HoldsFiles(folder / "data")) return stream;
    throw InputError::At((folder / "data.csv").string(), 0, "no such file, but frames are there");
  }
  if (stream.video.empty()) {
    ReadImages(folder, check_frames, stream, log);
  } else {
    ReadVideo(folder, yaml, check_frames, stream, log);
  }
  return stream;
}

void WriteCamera(const std::filesystem::path& folder, const CameraStream& stream) {
  const std::string pose = stream.has_T_RC ? YamlTransform(stream.calibration.T_RC) : "unknown";
  std::string text = CameraText(stream.calibration, stream.comment, pose);
  if (!stream.video.empty()) text += fmt::format("video: {}\n", YamlText(stream.video));
  WriteTextFile(folder / "sensor.yaml", text);
  if (!stream.video.empty() && !stream.frame_numbers.empty()) {
    WriteSeries(folder / "data.csv", {"frame []"}, stream.frame_numbers,
                [](CsvWriter& csv, int frame) { csv.Add(static_cast<TimeNs>(frame)); });
  } else if (!stream.filenames.empty()) {
    WriteSeries(folder / "data.csv", {"filename"}, stream.filenames,
                [](CsvWriter& csv, const std::string& name) { csv.Add(name); });
  }
}

}  // namespace flextip
