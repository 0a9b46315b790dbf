// strain0 and load0: moments inside the shaft and the force on its tip.
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

const std::vector<std::string> kStrainColumns = {"m1_y [Nm]", "m1_z [Nm]", "m2_y [Nm]",
                                                 "m2_z [Nm]"};
const std::vector<std::string> kLoadColumns = {"f_x [N]", "f_y [N]", "f_z [N]"};

}  // namespace

StrainStream ReadStrain(const std::filesystem::path& folder, double length_m, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  const auto s = yaml.Numbers("stations_from_wrist_m", 2);
  if (!(0 <= s[0] && s[0] < s[1] && s[1] <= length_m)) {
    throw yaml.Error("stations_from_wrist_m",
                     fmt::format("found [{}, {}], expected 0 <= s1 < s2 <= the shaft's length {}",
                                 s[0], s[1], length_m));
  }
  StrainStream stream{
      head.comment, head.rate_hz, {s[0], s[1]}, yaml.NonNegative("moment_noise_Nm"), {}};
  yaml.WarnUnknown(log);
  stream.moments_Nm = ReadSeries<Eigen::Vector4d>(
      folder / "data.csv", kStrainColumns, log, [](const CsvReader& csv) {
        return Eigen::Vector4d(csv.Number(1), csv.Number(2), csv.Number(3), csv.Number(4));
      });
  return stream;
}

void WriteStrain(const std::filesystem::path& folder, const StrainStream& stream) {
  WriteSeries(folder / "data.csv", kStrainColumns, stream.moments_Nm,
              [](CsvWriter& csv, const Eigen::Vector4d& m) {
                for (const double value : m) csv.Add(value);
              });
  const auto& s = stream.station_from_wrist_m;
  WriteTextFile(folder / "sensor.yaml",
                HeadText("strain", stream.comment, stream.rate_hz) +
                    fmt::format("stations_from_wrist_m: {}\nmoment_noise_Nm: {}\n",
                                YamlNumbers({s[0], s[1]}), YamlNumber(stream.moment_noise_Nm)));
}

LoadStream ReadLoad(const std::filesystem::path& folder, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  LoadStream stream{head.comment, head.rate_hz, yaml.NonNegative("force_noise_N"), {}};
  yaml.WarnUnknown(log);
  stream.f_tip_N =
      ReadSeries<Eigen::Vector3d>(folder / "data.csv", kLoadColumns, log,
                                  [](const CsvReader& csv) { return ReadVector3(csv, 1); });
  return stream;
}

void WriteLoad(const std::filesystem::path& folder, const LoadStream& stream) {
  WriteSeries(folder / "data.csv", kLoadColumns, stream.f_tip_N, AddVector3);
  WriteTextFile(folder / "sensor.yaml",
                HeadText("force", stream.comment, stream.rate_hz) +
                    fmt::format("force_noise_N: {}\n", YamlNumber(stream.force_noise_N)));
}

}  // namespace flextip
