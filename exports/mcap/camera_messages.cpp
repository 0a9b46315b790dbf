#include "exports/mcap/camera_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "recording/read_log.h"
#include "recording/streams/sensor_streams.h"
#include "report/result_files.h"
#include "vision/camera_model.h"

namespace flextip::exports {
namespace {

namespace fs = std::filesystem;

constexpr double kShown_m = 0.02;  // of the shaft behind the tip
constexpr int kPieces = 8;

std::string AsJpeg(const Image& image) {
  const int type = image.channels == 1 ? CV_8UC1 : CV_8UC3;
  const cv::Mat picture(image.height_px, image.width_px, type,
                        const_cast<std::uint8_t*>(image.data.data()));  // only read
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  return {bytes.begin(), bytes.end()};
}

/// The rows of a table at that time.
std::pair<std::size_t, std::size_t> RowsAt(const TimedTable& table, TimeNs t_ns) {
  const auto range = std::equal_range(table.cells.t_ns.begin(), table.cells.t_ns.end(), t_ns);
  return {static_cast<std::size_t>(range.first - table.cells.t_ns.begin()),
          static_cast<std::size_t>(range.second - table.cells.t_ns.begin())};
}

void AddTags(const TimedTable& table, std::size_t row, Annotations& annotations) {
  Annotations::Outline outline;
  for (int k = 0; k < 4; ++k) {
    const auto* x = table.cells.Column(fmt::format("c{}_x", k));
    const auto* y = table.cells.Column(fmt::format("c{}_y", k));
    if (x == nullptr || y == nullptr) return;
    outline.corners.emplace_back((*x)[row], (*y)[row]);
    if (!outline.corners.back().allFinite()) return;
  }
  if (const auto* id = table.cells.Texts("id")) outline.text = (*id)[row];
  annotations.outlines.push_back(std::move(outline));
}

void AddTip(const CameraModel& camera, const Pose& T_CR, const Eigen::Vector3d& p_RE,
            const std::optional<Eigen::Vector3d>& d_RE, Annotations& annotations) {
  const auto tip = camera.Project(T_CR * p_RE);
  if (!tip) return;
  annotations.marks.push_back(*tip);
  if (!d_RE) return;
  Annotations::Outline shaft{.corners = {}, .closed = false};
  for (int i = 0; i <= kPieces; ++i) {
    const auto px = camera.Project(T_CR * (p_RE - kShown_m * i / kPieces * *d_RE));
    if (px) shaft.corners.push_back(*px);
  }
  if (shaft.corners.size() > 1) annotations.outlines.push_back(std::move(shaft));
}

std::optional<Eigen::Vector3d> VectorAt(const TimedTable& table, const std::string& name,
                                        std::size_t row) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) {
    const auto* column = table.cells.Column(fmt::format("{}_{}", name, "xyz"[i]));
    if (column == nullptr || !std::isfinite((*column)[row])) return std::nullopt;
    v[i] = (*column)[row];
  }
  return v;
}

}  // namespace

RecordedCamera::RecordedCamera(fs::path recording, std::string name, CameraStream stream)
    : recording_(std::move(recording)), name_(std::move(name)), stream_(std::move(stream)) {
  for (const auto& frame : stream_.filenames) times_.push_back(frame.t_ns);
  for (const auto& frame : stream_.frame_numbers) times_.push_back(frame.t_ns);
}

std::string RecordedCamera::NextImage(TimeNs t_ns) {
  const auto file = std::find_if(stream_.filenames.begin(), stream_.filenames.end(),
                                 [&](const auto& f) { return f.t_ns == t_ns; });
  if (file != stream_.filenames.end()) {
    const fs::path path = recording_ / name_ / "data" / file->value;
    const std::string ending = path.extension().string();
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") {
      return ImageMessage(t_ns, name_, report::ReadBytes(path), ending == ".png" ? "png" : "jpeg");
    }
    return ImageMessage(t_ns, name_, AsJpeg(ReadImageFile(path)), "jpeg");
  }
  if (!video_) video_ = OpenRecordedFrames(recording_, name_, stream_);
  while (auto frame = video_->Next()) {
    if (frame->t_ns == t_ns) return ImageMessage(t_ns, name_, AsJpeg(frame->image), "jpeg");
  }
  throw InputError::At((recording_ / name_ / stream_.video).string(), 0,
                       "ends before the frames that data.csv lists");
}

Annotations RecordedCamera::Annotate(const std::vector<TimedTable>& tables, TimeNs t_ns) const {
  const CameraModel camera(stream_.calibration);
  const Pose T_CR = stream_.calibration.T_RC.Inverse();
  Annotations annotations;
  for (const TimedTable& table : tables) {
    const auto [from, to] = RowsAt(table, t_ns);
    const bool is_tags = table.name.ends_with("tags0"), is_tip = table.name.ends_with("vision0");
    for (std::size_t row = from; row < to; ++row) {
      if (is_tags) AddTags(table, row, annotations);
      const auto p_RE = is_tip ? VectorAt(table, "p_RE", row) : std::nullopt;
      if (p_RE) AddTip(camera, T_CR, *p_RE, VectorAt(table, "d_RE", row), annotations);
    }
  }
  return annotations;
}

std::vector<RecordedCamera> CamerasOf(const fs::path& folder) {
  std::vector<RecordedCamera> cameras;
  if (!fs::exists(folder / "recording.yaml")) return cameras;
  for (const char* name : {"cam0", "cam1"}) {
    if (!fs::exists(folder / name / "sensor.yaml")) continue;
    ReadLog log;
    RecordedCamera camera(folder, name, ReadCamera(folder / name, false, log));
    if (!camera.Times().empty()) cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace flextip::exports
