// em0 and em1: electromagnetic pose sensors.
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

const std::vector<std::string> kColumns = {"p_RS_x [m]", "p_RS_y [m]", "p_RS_z [m]", "q_RS_w []",
                                           "q_RS_x []",  "q_RS_y []",  "q_RS_z []"};

NoiseDistribution ReadDistribution(const YamlMap& yaml) {
  const std::string name = yaml.TextOr("noise_distribution", "gaussian");
  if (name == "gaussian") return NoiseDistribution::kGaussian;
  if (name == "uniform") return NoiseDistribution::kUniform;
  throw yaml.Error("noise_distribution",
                   fmt::format("found {}, expected gaussian or uniform", Quoted(name)));
}

}  // namespace

EmStream ReadEm(const std::filesystem::path& folder, double length_m, bool on_port, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  EmStream stream;
  stream.comment = head.comment;
  stream.rate_hz = head.rate_hz;
  stream.distance_from_tip_m = on_port ? yaml.NonNegativeOr("distance_from_tip_m", 0.0)
                                       : yaml.NonNegative("distance_from_tip_m");
  if (!on_port && stream.distance_from_tip_m > length_m) {
    throw yaml.Error("distance_from_tip_m",
                     fmt::format("found {}, expected at most the shaft's length {}",
                                 stream.distance_from_tip_m, length_m));
  }
  stream.position_noise_m = yaml.NonNegative("position_noise_m");
  stream.orientation_noise_rad = yaml.NonNegative("orientation_noise_rad");
  stream.noise_distribution = ReadDistribution(yaml);
  stream.registration_noise_rad = yaml.NonNegativeOr("registration_noise_rad", 0.0);
  stream.registration_noise_m = yaml.NonNegativeOr("registration_noise_m", 0.0);
  yaml.WarnUnknown(log);
  stream.samples =
      ReadSeries<EmSample>(folder / "data.csv", kColumns, log, [](const CsvReader& csv) {
        return EmSample{ReadVector3(csv, 1), ReadQuaternion(csv, 4)};
      });
  return stream;
}

void WriteEm(const std::filesystem::path& folder, const EmStream& stream) {
  WriteSeries(folder / "data.csv", kColumns, stream.samples,
              [](CsvWriter& csv, const EmSample& sample) {
                AddVector3(csv, sample.p_RS);
                AddQuaternion(csv, sample.q_RS);
              });
  std::string text = HeadText("pose", stream.comment, stream.rate_hz);
  text += fmt::format("distance_from_tip_m: {}\n", YamlNumber(stream.distance_from_tip_m));
  text += fmt::format("position_noise_m: {}\n", YamlNumber(stream.position_noise_m));
  text += fmt::format("orientation_noise_rad: {}\n", YamlNumber(stream.orientation_noise_rad));
  text += fmt::format(
      "noise_distribution: {}\n",
      stream.noise_distribution == NoiseDistribution::kUniform ? "uniform" : "gaussian");
  text += fmt::format("registration_noise_rad: {}\n", YamlNumber(stream.registration_noise_rad));
  text += fmt::format("registration_noise_m: {}\n", YamlNumber(stream.registration_noise_m));
  WriteTextFile(folder / "sensor.yaml", text);
}

}  // namespace flextip
