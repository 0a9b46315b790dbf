// wrist0 and command0: where the robot says it is, and where it was told to go.
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

const std::vector<std::string> kWristColumns = {
    "p_RW_x [m]", "p_RW_y [m]", "p_RW_z [m]", "q_RW_w []", "q_RW_x []", "q_RW_y []", "q_RW_z []"};
const std::vector<std::string> kCommandColumns = {"p_RW_x [m]", "p_RW_y [m]", "p_RW_z [m]"};

}  // namespace

WristStream ReadWrist(const std::filesystem::path& folder, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  WristStream stream{head.comment, head.rate_hz, yaml.NonNegative("position_noise_m"), 0.0, {}};
  // Where the orientation is not measured, its noise need not be stated either.
  bool measured = false;
  stream.samples =
      ReadSeries<WristSample>(folder / "data.csv", kWristColumns, log, [&](const CsvReader& csv) {
        WristSample sample{ReadVector3(csv, 1), {}};
        if (!AllEmpty(csv, 4, 4)) sample.q_RW = ReadQuaternion(csv, 4);
        measured |= sample.q_RW.has_value();
        return sample;
      });
  stream.orientation_noise_rad = measured ? yaml.NonNegative("orientation_noise_rad")
                                          : yaml.NonNegativeOr("orientation_noise_rad", 0.0);
  yaml.WarnUnknown(log);
  return stream;
}

void WriteWrist(const std::filesystem::path& folder, const WristStream& stream) {
  WriteSeries(folder / "data.csv", kWristColumns, stream.samples,
              [](CsvWriter& csv, const WristSample& sample) {
                AddVector3(csv, sample.p_RW);
                if (sample.q_RW) {
                  AddQuaternion(csv, *sample.q_RW);
                } else {
                  csv.AddEmpty(4);
                }
              });
  WriteTextFile(folder / "sensor.yaml",
                HeadText("pose", stream.comment, stream.rate_hz) +
                    fmt::format("position_noise_m: {}\norientation_noise_rad: {}\n",
                                YamlNumber(stream.position_noise_m),
                                YamlNumber(stream.orientation_noise_rad)));
}

CommandStream ReadCommand(const std::filesystem::path& folder, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  yaml.WarnUnknown(log);
  return {head.comment, head.rate_hz,
          ReadSeries<Eigen::Vector3d>(folder / "data.csv", kCommandColumns, log,
                                      [](const CsvReader& csv) { return ReadVector3(csv, 1); })};
}

void WriteCommand(const std::filesystem::path& folder, const CommandStream& stream) {
  WriteSeries(folder / "data.csv", kCommandColumns, stream.p_RW, AddVector3);
  WriteTextFile(folder / "sensor.yaml", HeadText("command", stream.comment, stream.rate_hz));
}

}  // namespace flextip
