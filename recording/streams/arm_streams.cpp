// joints0, joints_command0, joints_seen0, torque0 and pose0: an arm's joints, their efforts, and
// its last link as an outside tracker sees it.
#include <set>

#include "recording/arm/arm_file.h"
#include "recording/streams/sensor_head.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

constexpr const char* kJointFolders[] = {"joints0", "joints_command0", "joints_seen0", "torque0"};
const std::vector<std::string> kPoseColumns = {
    "p_RK_x [m]", "p_RK_y [m]", "p_RK_z [m]", "q_RK_w []", "q_RK_x []", "q_RK_y []", "q_RK_z []"};

std::vector<JointType> TypesOf(const Arm& arm) {
  std::vector<JointType> types;
  for (const ArmJoint& joint : arm.joints) types.push_back(joint.type);
  return types;
}

std::vector<std::string> JointColumns(const std::vector<JointType>& types) {
  std::vector<std::string> columns;
  for (std::size_t i = 0; i < types.size(); ++i)
    columns.push_back(fmt::format("q{} [{}]", i + 1, UnitOf(types[i])));
  return columns;
}

std::vector<std::string> TorqueColumns(const std::vector<JointType>& types) {
  std::vector<std::string> columns;
  for (std::size_t i = 0; i < types.size(); ++i)
    columns.push_back(fmt::format("tau{} [{}]", i + 1, EffortUnitOf(types[i])));
  return columns;
}

/// A list of standard deviations, one a joint.
std::vector<double> ReadNoise(const YamlMap& yaml, const std::string& key, std::size_t count) {
  const std::vector<double> noise = yaml.Numbers(key);
  if (noise.size() != count)
    throw yaml.Error(key, fmt::format("found {} numbers, expected {}", noise.size(), count));
  for (const double sd : noise)
    if (sd < 0.0) throw yaml.Error(key, fmt::format("found {}, expected 0 or more", sd));
  return noise;
}

Eigen::VectorXd ReadRow(const CsvReader& csv, std::size_t count) {
  Eigen::VectorXd row(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) row[static_cast<Eigen::Index>(i)] = csv.Number(i + 1);
  return row;
}

void AddRow(CsvWriter& csv, const Eigen::VectorXd& row) {
  for (const double value : row) csv.Add(value);
}

/// How many efforts the header has: those of the arm's first joints.
std::size_t CountEfforts(const std::filesystem::path& file, const Arm& arm) {
  ReadLog unused;
  const CsvReader csv(file, unused);
  const std::size_t count = csv.Columns().empty() ? 0 : csv.Columns().size() - 1;
  return std::clamp<std::size_t>(count, 1, arm.joints.size());
}

}  // namespace

JointStream ReadJoints(const std::filesystem::path& folder, const Arm& arm, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  JointStream stream{head.comment, head.rate_hz, TypesOf(arm), {}, {}};
  (void)yaml.Has("arm");
  const std::size_t count = arm.joints.size();
  const bool needed = folder.filename() != "joints_command0";
  stream.noise = needed || yaml.Has("joint_noise") ? ReadNoise(yaml, "joint_noise", count)
                                                   : std::vector<double>(count, 0.0);
  yaml.WarnUnknown(log);
  stream.q = ReadSeries<Eigen::VectorXd>(folder / "data.csv", JointColumns(stream.types), log,
                                         [&](const CsvReader& csv) { return ReadRow(csv, count); });
  return stream;
}

void WriteJoints(const std::filesystem::path& folder, const JointStream& stream) {
  WriteSeries(folder / "data.csv", JointColumns(stream.types), stream.q, AddRow);
  WriteTextFile(folder / "sensor.yaml",
                HeadText("joints", stream.comment, stream.rate_hz) +
                    fmt::format("arm: ../arm.yaml\njoint_noise: {}\n", YamlNumbers(stream.noise)));
}

TorqueStream ReadTorque(const std::filesystem::path& folder, const Arm& arm, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  TorqueStream stream{head.comment, head.rate_hz, TypesOf(arm), {}, {}};
  (void)yaml.Has("arm");
  stream.types.resize(CountEfforts(folder / "data.csv", arm));
  stream.noise = ReadNoise(yaml, "torque_noise", stream.types.size());
  yaml.WarnUnknown(log);
  stream.tau = ReadSeries<Eigen::VectorXd>(
      folder / "data.csv", TorqueColumns(stream.types), log,
      [&](const CsvReader& csv) { return ReadRow(csv, stream.types.size()); });
  return stream;
}

void WriteTorque(const std::filesystem::path& folder, const TorqueStream& stream) {
  WriteSeries(folder / "data.csv", TorqueColumns(stream.types), stream.tau, AddRow);
  WriteTextFile(folder / "sensor.yaml",
                HeadText("torque", stream.comment, stream.rate_hz) +
                    fmt::format("arm: ../arm.yaml\ntorque_noise: {}\n", YamlNumbers(stream.noise)));
}

PoseStream ReadPose(const std::filesystem::path& folder, ReadLog& log) {
  const auto yaml = YamlMap::Load(folder / "sensor.yaml");
  const auto head = ReadHead(yaml);
  PoseStream stream;
  stream.comment = head.comment;
  stream.rate_hz = head.rate_hz;
  stream.position_noise_m = yaml.NonNegative("position_noise_m");
  stream.registration_noise_rad = yaml.NonNegativeOr("registration_noise_rad", 0.0);
  stream.registration_noise_m = yaml.NonNegativeOr("registration_noise_m", 0.0);
  (void)yaml.Has("arm");
  bool measured = false;
  stream.samples =
      ReadSeries<PoseSample>(folder / "data.csv", kPoseColumns, log, [&](const CsvReader& csv) {
        PoseSample sample{ReadVector3(csv, 1), {}};
        if (!AllEmpty(csv, 4, 4)) sample.q_RK = ReadQuaternion(csv, 4);
        measured |= sample.q_RK.has_value();
        return sample;
      });
  stream.orientation_noise_rad = measured ? yaml.NonNegative("orientation_noise_rad")
                                          : yaml.NonNegativeOr("orientation_noise_rad", 0.0);
  yaml.WarnUnknown(log);
  return stream;
}

void WritePose(const std::filesystem::path& folder, const PoseStream& stream) {
  WriteSeries(folder / "data.csv", kPoseColumns, stream.samples,
              [](CsvWriter& csv, const PoseSample& sample) {
                AddVector3(csv, sample.p_RK);
                if (sample.q_RK) {
                  AddQuaternion(csv, *sample.q_RK);
                } else {
                  csv.AddEmpty(4);
                }
              });
  std::string text =
      HeadText("pose", stream.comment, stream.rate_hz) +
      fmt::format("position_noise_m: {}\norientation_noise_rad: {}\n",
                  YamlNumber(stream.position_noise_m), YamlNumber(stream.orientation_noise_rad));
  if (stream.registration_noise_m > 0.0 || stream.registration_noise_rad > 0.0) {
    text += fmt::format("registration_noise_m: {}\nregistration_noise_rad: {}\n",
                        YamlNumber(stream.registration_noise_m),
                        YamlNumber(stream.registration_noise_rad));
  }
  WriteTextFile(folder / "sensor.yaml", text);
}

std::optional<Arm> ReadArmOf(const std::filesystem::path& recording, ReadLog& log) {
  std::filesystem::path file, named_by;
  for (const char* sensor : kJointFolders) {
    const std::filesystem::path folder = recording / sensor;
    if (!std::filesystem::is_directory(folder)) continue;
    const auto yaml = YamlMap::Load(folder / "sensor.yaml");
    std::filesystem::path here = (folder / yaml.TextOr("arm", "../arm.yaml")).lexically_normal();
    // "arm.yaml" may stand in the sensor's folder or in the recording's.
    if (!std::filesystem::exists(here))
      here = (recording / yaml.TextOr("arm", "arm.yaml")).lexically_normal();
    if (!std::filesystem::exists(here) && !yaml.Has("arm")) {
      log.warnings.push_back(
          folder.string() + ": not used, as neither arm: nor an arm.yaml says what its joints are");
      continue;
    }
    if (!std::filesystem::exists(here)) {
      throw yaml.Error("arm", fmt::format("no such file {}, expected the arm's arm.yaml or URDF",
                                          Quoted(here.string())));
    }
    if (!file.empty() && here != file) {
      throw yaml.Error(
          "arm", fmt::format("found {}, but {} names {}: expected one arm", Quoted(here.string()),
                             named_by.string(), Quoted(file.string())));
    }
    file = here;
    named_by = folder / "sensor.yaml";
  }
  if (file.empty()) return {};
  return ReadArm(file, log);
}

}  // namespace flextip
