#include "live/recorder/stream_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <system_error>

#include "core/error.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"

namespace flextip::live {
namespace {

void AddFields(CsvWriter& csv, const AnySample& sample) {
  if (const auto* wrist = std::get_if<WristSample>(&sample)) {
    AddVector3(csv, wrist->p_RW);
    if (wrist->q_RW) {
      AddQuaternion(csv, *wrist->q_RW);
    } else {
      csv.AddEmpty(4);
    }
  } else if (const auto* em = std::get_if<EmSample>(&sample)) {
    AddVector3(csv, em->p_RS);
    AddQuaternion(csv, em->q_RS);
  } else if (const auto* moments = std::get_if<Eigen::Vector4d>(&sample)) {
    for (const double value : *moments) csv.Add(value);
  } else {
    AddVector3(csv, std::get<Eigen::Vector3d>(sample));
  }
}

std::size_t ColumnsOf(const AnySample& sample) {
  constexpr std::size_t columns[] = {7, 13, 7, 4, 3};
  return columns[sample.index()];
}

/// Returns the row's text: of a table of that width, without its header.
std::string RowOf(const Arrived<AnySample>& sample) {
  CsvWriter csv(std::vector<std::string>(1 + ColumnsOf(sample.value), "x"));
  (void)csv.TakeText();
  if (const auto* seen = std::get_if<SeenTip>(&sample.value)) {
    AddVisionRow(csv, {sample.t_ns, seen->tip});
  } else {
    csv.Add(sample.t_ns);
    AddFields(csv, sample.value);
    csv.EndRow();
  }
  return csv.TakeText();
}

}  // namespace

LineFile::LineFile(const std::filesystem::path& file)
    : file_(file),
      descriptor_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0)
    throw WorkError(file.string() + ": " + std::generic_category().message(errno));
}

LineFile::~LineFile() { close(descriptor_); }

void LineFile::Append(const std::string& lines) {
  for (std::size_t done = 0; done < lines.size();) {
    const ssize_t written = write(descriptor_, lines.data() + done, lines.size() - done);
    if (written < 0 && errno != EINTR)
      throw WorkError(file_.string() + ": " + std::generic_category().message(errno));
    if (written > 0) done += static_cast<std::size_t>(written);
  }
}

StreamFile::StreamFile(std::filesystem::path recording, StreamName stream, const Recording& base)
    : recording_(std::move(recording)), stream_(stream), base_(&base) {}

StreamFile::StreamFile(std::filesystem::path recording, const std::string& comment, double rate_hz,
                       const Recording& base)
    : StreamFile(std::move(recording), StreamName::kWrist, base) {
  commands_ = CommandStream{comment, rate_hz, {}};
}

void StreamFile::Add(const Arrived<AnySample>& sample) {
  if (sample.t_ns <= last_ns_) return;
  last_ns_ = sample.t_ns;
  ++samples_;
  if (const auto* seen = std::get_if<SeenTip>(&sample.value))
    squared_noise_ += seen->direction_noise_rad * seen->direction_noise_rad;
  if (first_) {
    rows_ += RowOf(sample);
    return;
  }
  first_ = sample;
  Begin(recording_, WithOne(0.0));
  file_ = std::make_unique<LineFile>(recording_ / Folder() / "data.csv");
}

void StreamFile::Flush() {
  if (rows_.empty()) return;
  file_->Append(rows_);
  rows_.clear();
}

/// The recording's writers make folder, settings, header and first row.
void StreamFile::Begin(const std::filesystem::path& recording, const Recording& one) const {
  const std::filesystem::path folder = recording / Folder();
  if (commands_) return WriteCommand(folder, *one.command0);
  switch (stream_) {
    case StreamName::kWrist:
      return WriteWrist(folder, *one.wrist0);
    case StreamName::kTip:
      return WriteVision(folder, *one.vision0);
    case StreamName::kEm0:
      return WriteEm(folder, *one.em0);
    case StreamName::kEm1:
      return WriteEm(folder, *one.em1);
    case StreamName::kStrain:
      return WriteStrain(folder, *one.strain0);
    case StreamName::kLoad:
      return WriteLoad(folder, *one.load0);
  }
}

/// The stream's settings with the first sample; `rate_hz` 0: as in the settings.
Recording StreamFile::WithOne(double rate_hz) const {
  Recording one = *base_;
  const AnySample& value = first_->value;
  const auto put = [&](auto& stream, auto& samples, const auto& sample) {
    samples.assign(1, {first_->t_ns, sample});
    if (rate_hz > 0.0) stream.rate_hz = rate_hz;
  };
  if (commands_) {
    one.command0 = commands_;
    put(*one.command0, one.command0->p_RW, std::get<Eigen::Vector3d>(value));
    return one;
  }
  switch (stream_) {
    case StreamName::kWrist:
      put(*one.wrist0, one.wrist0->samples, std::get<WristSample>(value));
      break;
    case StreamName::kTip:
      put(*one.vision0, one.vision0->tips, std::get<SeenTip>(value).tip);
      one.vision0->direction_noise_rad = std::sqrt(squared_noise_ / static_cast<double>(samples_));
      break;
    case StreamName::kEm0:
      put(*one.em0, one.em0->samples, std::get<EmSample>(value));
      break;
    case StreamName::kEm1:
      put(*one.em1, one.em1->samples, std::get<EmSample>(value));
      break;
    case StreamName::kStrain:
      put(*one.strain0, one.strain0->moments_Nm, std::get<Eigen::Vector4d>(value));
      break;
    case StreamName::kLoad:
      put(*one.load0, one.load0->f_tip_N, std::get<Eigen::Vector3d>(value));
      break;
  }
  return one;
}

void StreamFile::Finish() {
  if (!first_) return;
  Flush();
  const double span_s = 1e-9 * static_cast<double>(last_ns_ - first_->t_ns);
  const double rate_hz = samples_ > 1 ? static_cast<double>(samples_ - 1) / span_s : 0.0;
  // The settings alone, by the writers that make a whole stream.
  const std::filesystem::path beside = recording_ / ".settings";
  Begin(beside, WithOne(rate_hz));
  std::filesystem::rename(beside / Folder() / "sensor.yaml", recording_ / Folder() / "sensor.yaml");
  std::filesystem::remove_all(beside);
}

}  // namespace flextip::live
