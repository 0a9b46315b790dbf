// Options as a plan.
#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "apps/import/options.h"
#include "core/error.h"
#include "exchange/mapping_file.h"
#include "exchange/streams/names.h"
#include "exchange/streams/sensor_settings.h"
#include "exchange/values/orientation.h"
#include "exchange/values/times.h"
#include "exchange/values/units.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using exchange::CameraPlan;
using exchange::ImportPlan;
using exchange::StreamPlan;
using Parts = std::pair<std::string, std::string>;

/// "em0" and "mm" of "em0=mm". Throws InputError that names the option and its form.
Parts SplitAt(const std::string& option, const std::string& text, char separator,
              const std::string& form) {
  const auto at = text.find(separator);
  if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
    throw InputError(fmt::format("{}: found '{}', expected {}", option, text, form));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

/// The camera's name and the value of "cam1=FILE"; cam0 where there is no name.
Parts OfCamera(const std::string& text) {
  const auto at = text.find('=');
  if (at != std::string::npos && exchange::IsCamera(text.substr(0, at))) {
    return {text.substr(0, at), text.substr(at + 1)};
  }
  return {"cam0", text};
}

InputError UnknownStream(const std::string& option, const std::string& name) {
  return InputError(fmt::format("{}: found the stream '{}', expected {}, cam0 or cam1", option,
                                name, exchange::TableStreamsText()));
}

/// The stream's plan; of a camera that of its file of times.
StreamPlan& StreamOf(ImportPlan& plan, const std::string& option, const std::string& name) {
  if (exchange::IsCamera(name)) return plan.cameras[name].times;
  if (!exchange::IsTableStream(name) && !exchange::IsJointStream(name)) {
    throw UnknownStream(option, name);
  }
  return plan.streams[name];
}

// A file that is there is a table or a video; anything else is a topic, where there are bags.
void TellStream(ImportPlan& plan, const std::string& text) {
  const auto [name, source] = SplitAt("--stream", text, '=', "STREAM=FILE, as em0=tracker.csv");
  std::error_code error;
  const bool is_topic = !plan.bags.empty() && !fs::is_regular_file(source, error);
  if (exchange::IsCamera(name)) {
    CameraPlan& camera = plan.cameras[name];
    camera.video = is_topic ? "" : source;
    camera.topic = is_topic ? source : "";
  } else {
    StreamPlan& stream = StreamOf(plan, "--stream", name);
    stream.file = is_topic ? "" : source;
    stream.topic = is_topic ? source : "";
  }
  plan.Told(name + ".file");
  plan.Told(name + ".topic");
}

void TellUnit(ImportPlan& plan, const std::string& text) {
  const auto [name, unit_name] = SplitAt("--unit", text, '=', "STREAM=UNIT, as em0=mm");
  StreamPlan& stream = StreamOf(plan, "--unit", name);
  auto unit = exchange::ParseUnit(unit_name);
  if (name == "strain0") {
    if (const auto moment = exchange::ParseUnit(unit_name, "moment")) unit = moment;
  }
  if (!unit) {
    throw InputError(
        fmt::format("--unit: found '{}', expected a unit like mm, ms, deg, N or Nm", unit_name));
  }
  stream.units[unit->kind] = unit->name;
  plan.Told(fmt::format("{}.units.{}", name, unit->kind));
}

void TellOffset(ImportPlan& plan, const std::string& text) {
  const auto [name, seconds] = SplitAt("--offset", text, '=', "STREAM=SECONDS, as em0=12.3");
  const auto offset = exchange::DecimalTime(seconds, "s");
  if (!offset) throw InputError(fmt::format("--offset: found '{}', expected seconds", seconds));
  if (exchange::IsCamera(name)) {
    plan.cameras[name].offset_ns = *offset;
  } else {
    StreamOf(plan, "--offset", name).offset_ns = *offset;
  }
}

void TellQuaternion(ImportPlan& plan, const std::string& text) {
  const auto [name, order] = SplitAt("--quaternion", text, '=', "STREAM=wxyz or STREAM=xyzw");
  if (order != "wxyz" && order != "xyzw") {
    throw InputError(fmt::format("--quaternion: found '{}', expected wxyz or xyzw", order));
  }
  StreamOf(plan, "--quaternion", name).quaternion = order;
  plan.Told(name + ".quaternion");
}

void TellOrientation(ImportPlan& plan, const std::string& text) {
  const auto [name, kind] = SplitAt("--orientation", text, '=', "STREAM=KIND");
  StreamOf(plan, "--orientation", name).orientation = kind;
  plan.Told(name + ".orientation");
}

void TellAxis(ImportPlan& plan, const std::string& text) {
  const auto [name, axis] = SplitAt("--axis", text, '=', "STREAM=AXIS, as em0=z");
  if (!exchange::IsAxis(axis)) {
    throw InputError(fmt::format("--axis: found '{}', expected x, -x, y, -y, z or -z", axis));
  }
  StreamOf(plan, "--axis", name).axis = axis;
  plan.Told(name + ".axis");
}

void TellColumn(ImportPlan& plan, const std::string& text) {
  const std::string form = "STREAM.ROLE=COLUMN, as em0.x=Tx";
  const auto [place, column] = SplitAt("--column", text, '=', form);
  const auto [name, role] = SplitAt("--column", place, '.', form);
  StreamOf(plan, "--column", name).columns[role] = column;
}

void TellSetting(ImportPlan& plan, const std::string& text) {
  const std::string form = "STREAM.KEY=VALUE, as em0.position_noise_m=1e-4";
  const auto [place, value] = SplitAt("--set", text, '=', form);
  const auto [name, key] = SplitAt("--set", place, '.', form);
  exchange::TellSensor(plan, "--set", name, key, value);
}

void TellStreams(const ImportOptions& options, ImportPlan& plan) {
  const auto each = [&](const std::vector<std::string>& texts, auto tell) {
    for (const auto& text : texts) tell(plan, text);
  };
  each(options.streams, TellStream);
  each(options.units, TellUnit);
  each(options.offsets, TellOffset);
  each(options.quaternions, TellQuaternion);
  each(options.orientations, TellOrientation);
  each(options.axes, TellAxis);
  each(options.columns, TellColumn);
  each(options.sets, TellSetting);
}

void TellInstrument(const ImportOptions& options, ImportPlan& plan) {
  const auto tell = [&](const auto& value, auto& place, const std::string& key) {
    if (!value) return;
    place = value;
    plan.Told(key);
  };
  tell(options.length_m, plan.length_m, "instrument.length_m");
  tell(options.diameter_m, plan.outer_diameter_m, "instrument.outer_diameter_m");
  tell(options.stiffness_Nm2, plan.bending_stiffness_Nm2, "instrument.bending_stiffness_Nm2");
  tell(options.mass_per_length_kg_m, plan.mass_per_length_kg_m, "instrument.mass_per_length_kg_m");
  tell(options.port, plan.p_RP, "port.position_m");
  tell(options.gravity, plan.gravity_m_s2, "gravity_m_s2");
}

void TellCameras(const ImportOptions& options, ImportPlan& plan) {
  const auto each = [&](const std::vector<std::string>& texts, auto take) {
    for (const auto& text : texts) {
      const auto [name, value] = OfCamera(text);
      take(plan.cameras[name], name, value);
    }
  };
  using Name = const std::string&;
  each(options.cameras, [](CameraPlan& camera, Name, Name file) { camera.camera = file; });
  each(options.poses, [](CameraPlan& camera, Name, Name file) { camera.pose = file; });
  each(options.times, [](CameraPlan& camera, Name, Name file) {
    camera.times.file = file;
    camera.start.clear();
  });
  each(options.starts, [&](CameraPlan& camera, Name name, Name start) {
    camera.start = start;
    camera.times.file.clear();
    plan.Told(name + ".start");
  });
  if (!options.collar.empty()) plan.collar = options.collar;
  if (!options.arm.empty()) plan.arm = options.arm;
  for (auto& [name, camera] : plan.cameras) {
    camera.link = camera.link || options.link;
    if (!options.rate_hz) continue;
    camera.rate_hz = options.rate_hz;
    plan.Told(name + ".frame_rate_hz");
  }
}

// A table of a mapped name takes the mapped one's place: the same mapping for another session.
void AddTable(const fs::path& file, ImportPlan& plan) {
  bool mapped = false;
  for (auto& [name, stream] : plan.streams) {
    if (stream.file.filename() != file.filename()) continue;
    stream.file = file;
    mapped = true;
  }
  if (!mapped) plan.tables.push_back(file);
}

void TellInputs(const ImportOptions& options, ImportPlan& plan) {
  const bool bags = options.format == "rosbag" || options.format == "mcap";
  if (bags && !options.inputs.empty()) plan.bags = options.inputs;
  for (std::size_t i = 0; i < options.inputs.size(); ++i) {
    if (options.format == "csv") AddTable(options.inputs[i], plan);
    if (options.format == "video") plan.cameras[i == 0 ? "cam0" : "cam1"].video = options.inputs[i];
    if (options.format == "dvrk") plan.session = options.inputs[i];
  }
}

}  // namespace

ImportPlan PlanOf(const ImportOptions& options) {
  ImportPlan plan;
  if (!options.map.empty()) exchange::ReadMapping(options.map, plan);
  if (!options.settings.empty()) exchange::ReadMapping(options.settings, plan);
  TellInputs(options, plan);
  TellStreams(options, plan);
  TellCameras(options, plan);
  TellInstrument(options, plan);
  return plan;
}

std::vector<fs::path> InputsOf(const ImportPlan& plan, const ImportOptions& options) {
  std::vector<fs::path> files = exchange::FilesOf(plan);
  for (const auto& file : {options.map, options.settings}) {
    if (!file.empty()) files.push_back(file);
  }
  return files;
}

}  // namespace flextip
