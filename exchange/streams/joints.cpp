#include "exchange/streams/joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "exchange/list_text.h"
#include "exchange/streams/names.h"
#include "exchange/streams/noise.h"
#include "exchange/streams/stream_settings.h"
#include "recording/arm/arm_file.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

bool Slides(const std::string& joint) {
  static const std::array<std::string, 4> hints{"insertion", "prismatic", "linear", "slide"};
  for (const auto& word : WordsOf(joint)) {
    if (std::find(hints.begin(), hints.end(), word) != hints.end()) return true;
  }
  return false;
}

std::vector<bool> SlidingByName(const JointSeries& series, ImportLog& log) {
  std::vector<bool> prismatic;
  std::string sliding;
  for (const auto& name : series.names) {
    prismatic.push_back(Slides(name));
    if (Slides(name)) AppendItem(sliding, name);
  }
  log.Assume(series.stream + ".prismatic",
             sliding.empty() ? "none, by the joints' names" : sliding + ", by their names");
  return prismatic;
}

/// Efforts may be of the first joints alone.
std::vector<bool> SlidingByArm(const JointSeries& series, const ImportPlan& plan, ImportLog& log) {
  ReadLog read_log;
  const Arm arm = ReadArm(plan.arm, read_log);
  for (const std::string& warning : read_log.warnings) log.Warn(warning);
  const std::size_t count = series.names.size(), expected = arm.joints.size();
  if (series.stream == "torque0" ? count > expected : count != expected) {
    throw InputError(fmt::format("{} has {} joints ({}), the arm of {} has {}", series.stream,
                                 count, fmt::join(series.names, ", "), plan.arm.string(),
                                 expected));
  }
  std::vector<bool> prismatic;
  for (std::size_t i = 0; i < count; ++i)
    prismatic.push_back(arm.joints[i].type == JointType::kPrismatic);
  return prismatic;
}

std::vector<double> NoiseOf(const JointSeries& series, const std::string& key,
                            const Settings& settings, ImportLog& log) {
  std::vector<double> noise = settings.List(key);
  if (noise.size() == series.names.size()) return noise;
  if (!noise.empty()) {
    throw InputError(fmt::format("{}.{}: found {} numbers, expected {}", series.stream, key,
                                 noise.size(), series.names.size()));
  }
  for (std::size_t joint = 0; joint < series.names.size(); ++joint) {
    std::vector<Eigen::VectorXd> values;
    for (const auto& row : series.values)
      values.emplace_back(Eigen::VectorXd::Constant(1, row[joint]));
    const auto measured = MeasureNoise(values);
    noise.push_back(measured ? measured->sd : 0.0);  // of a joint that never moved
  }
  log.Assume(fmt::format("{}.{}", series.stream, key), "measured by third differences");
  return noise;
}

std::string UnitOf(const JointStream& joints, std::size_t joint) {
  if (joints.series.stream == "torque0") return joints.prismatic[joint] ? "N" : "Nm";
  return joints.prismatic[joint] ? "m" : "rad";
}

const char* NoiseKey(const JointSeries& series) {
  return series.stream == "torque0" ? "torque_noise" : "joint_noise";
}

}  // namespace

std::string ArmFileName(const ImportPlan& plan) {
  if (plan.arm.empty()) return "";
  return plan.arm.extension() == ".urdf" ? "arm.urdf" : "arm.yaml";
}

JointStream TakeJoints(JointSeries series, const ImportPlan& plan, ImportLog& log) {
  JointStream joints;
  Settings settings(series.stream, plan, log);
  joints.rate_hz = settings.Rate(series.t_ns);
  joints.noise = NoiseOf(series, NoiseKey(series), settings, log);
  joints.arm_file = ArmFileName(plan);
  joints.prismatic =
      plan.arm.empty() ? SlidingByName(series, log) : SlidingByArm(series, plan, log);
  joints.series = std::move(series);
  return joints;
}

StreamLine Describe(const JointStream& joints) {
  const JointSeries& s = joints.series;
  std::string first;
  for (std::size_t i = 0; i < s.names.size(); ++i) {
    first += fmt::format("{}{:.6g} {}", i == 0 ? "" : ", ", s.values.front()[i], UnitOf(joints, i));
  }
  return {s.stream, s.t_ns.size(), s.t_ns.front(), s.t_ns.back(), joints.rate_hz, first};
}

void WriteJoints(const std::filesystem::path& folder, const JointStream& joints) {
  const JointSeries& s = joints.series;
  const bool torques = s.stream == "torque0";
  std::vector<std::string> columns{"timestamp [ns]"};
  for (std::size_t i = 0; i < s.names.size(); ++i) {
    columns.push_back(fmt::format("{}{} [{}]", torques ? "tau" : "q", i + 1, UnitOf(joints, i)));
  }
  CsvWriter csv(columns);
  for (std::size_t row = 0; row < s.t_ns.size(); ++row) {
    csv.Add(s.t_ns[row]);
    for (const double value : s.values[row]) csv.Add(value);
    csv.EndRow();
  }
  WriteTextFile(folder / s.stream / "data.csv", csv.text());
  WriteTextFile(folder / s.stream / "sensor.yaml",
                fmt::format("sensor_type: {}\ncomment: {}\nrate_hz: {}\n{}: {}\n{}",
                            torques ? "torque" : "joints",
                            YamlText(fmt::format("joints {}", fmt::join(s.names, ", "))),
                            YamlNumber(joints.rate_hz), NoiseKey(s), YamlNumbers(joints.noise),
                            joints.arm_file.empty() ? "" : "arm: ../" + joints.arm_file + "\n"));
}

}  // namespace flextip::exchange
