// vision0: the tip as seen.
#include <algorithm>
#include <array>

#include "core/linear_algebra.h"
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

const std::vector<std::string> kColumns = {
    "p_RE_x [m]",  "p_RE_y [m]",  "p_RE_z [m]",  "cov_xx [m2]", "cov_xy [m2]",
    "cov_xz [m2]", "cov_yy [m2]", "cov_yz [m2]", "cov_zz [m2]", "d_RE_x []",
    "d_RE_y []",   "d_RE_z []",   "status []"};
constexpr std::size_t kPosition = 1, kCovariance = 4, kDirection = 10, kStatus = 13;

TipStatus ReadStatus(const CsvReader& csv) {
  const auto text = csv.Text(kStatus);
  if (text == "ok") return TipStatus::kOk;
  if (text == "predicted") return TipStatus::kPredicted;
  if (text == "lost") return TipStatus::kLost;
  throw csv.Error(fmt::format("found status {}, expected ok, predicted or lost", Quoted(text)));
}

Eigen::Matrix3d ReadCovariance(const CsvReader& csv) {
  std::array<double, 6> c{};
  for (std::size_t i = 0; i < 6; ++i) c[i] = csv.Number(kCovariance + i);
  Eigen::Matrix3d covariance;
  covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  // Rounding to a few digits may leave a vanishing eigenvalue a little below zero.
  const Eigen::Vector3d values = SymmetricEigenvalues(covariance);
  if (values(0) < -1e-6 * std::max(values(2), 0.0) || values(2) < 0) {
    throw csv.Error(fmt::format(
        "the covariance has the eigenvalue {:.3g} m2, expected none below 0", values(0)));
  }
  return covariance;
}

// Position and covariance of a lost row mean nothing: its fields may be empty, and must be numbers
// where they are not, but are not taken over.
TipObservation ReadLostRow(const CsvReader& csv) {
  for (std::size_t i = kPosition; i < kStatus; ++i) {
    if (!csv.Empty(i)) (void)csv.Number(i);
  }
  return {};
}

TipObservation ReadRow(const CsvReader& csv) {
  const TipStatus status = ReadStatus(csv);
  if (status == TipStatus::kLost) return ReadLostRow(csv);
  TipObservation tip{status, ReadVector3(csv, kPosition), ReadCovariance(csv), {}};
  if (!AllEmpty(csv, kDirection, 3)) tip.d_RE = ReadDirection(csv, kDirection);
  return tip;
}

void AddRow(CsvWriter& csv, const TipObservation& tip) {
  if (tip.status == TipStatus::kLost) {
    csv.AddEmpty(12).Add(Name(tip.status));
    return;
  }
  AddVector3(csv, tip.p_RE);
  const auto& c = tip.covariance_m2;
  csv.Add(c(0, 0)).Add(c(0, 1)).Add(c(0, 2)).Add(c(1, 1)).Add(c(1, 2)).Add(c(2, 2));
  if (tip.d_RE) {
    AddVector3(csv, *tip.d_RE);
  } else {
    csv.AddEmpty(3);
  }
  csv.Add(Name(tip.status));
}

}  // namespace

VisionStream ReadVision(const std::filesystem::path& folder, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  VisionStream stream;
  stream.comment = head.comment;
  stream.rate_hz = head.rate_hz;
  stream.camera = yaml.TextOr("camera", "cam0");
  stream.registration_noise_rad = yaml.NonNegativeOr("registration_noise_rad", 0.0);
  stream.registration_noise_m = yaml.NonNegativeOr("registration_noise_m", 0.0);
  stream.tips = ReadSeries<TipObservation>(folder / "data.csv", kColumns, log, ReadRow);
  const bool seen = std::any_of(stream.tips.begin(), stream.tips.end(),
                                [](const auto& tip) { return tip.value.d_RE.has_value(); });
  stream.direction_noise_rad = seen ? yaml.NonNegative("direction_noise_rad")
                                    : yaml.NonNegativeOr("direction_noise_rad", 0.0);
  yaml.WarnUnknown(log);
  return stream;
}

const std::vector<std::string>& VisionColumns() { return kColumns; }

void AddVisionRow(CsvWriter& csv, const Sample<TipObservation>& tip) {
  csv.Add(tip.t_ns);
  AddRow(csv, tip.value);
  csv.EndRow();
}

void WriteVision(const std::filesystem::path& folder, const VisionStream& stream) {
  WriteSeries(folder / "data.csv", kColumns, stream.tips, AddRow);
  WriteVisionSettings(folder, stream);
}

void WriteVisionSettings(const std::filesystem::path& folder, const VisionStream& stream) {
  std::string text = HeadText("vision", stream.comment, stream.rate_hz);
  text += fmt::format("camera: {}\n", YamlText(stream.camera));
  text += fmt::format("direction_noise_rad: {}\n", YamlNumber(stream.direction_noise_rad));
  text += fmt::format("registration_noise_rad: {}\n", YamlNumber(stream.registration_noise_rad));
  text += fmt::format("registration_noise_m: {}\n", YamlNumber(stream.registration_noise_m));
  WriteTextFile(folder / "sensor.yaml", text);
}

}  // namespace flextip
