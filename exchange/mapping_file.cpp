#include "exchange/mapping_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "exchange/streams/names.h"
#include "exchange/streams/sensor_settings.h"
#include "exchange/values/times.h"
#include "exchange/values/units.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

void CheckMappingFormat(const YamlMap& yaml) {
  const auto format = yaml.TextOr("format", "flextip-import");
  if (format != "flextip-import" && format != "flextip-recording") {
    throw yaml.Error("format", fmt::format("found {}, expected flextip-import or flextip-recording",
                                           Quoted(format)));
  }
  if (!yaml.Has("version")) return;
  if (const auto version = yaml.Integer("version"); version != kMappingVersion) {
    throw yaml.Error("version", fmt::format("found the unknown version {}, expected {}", version,
                                            kMappingVersion));
  }
}

void RefuseUnknown(const YamlMap& yaml) {
  const auto unknown = yaml.Unasked();
  if (!unknown.empty()) throw yaml.Error(unknown.front(), "is no key of a mapping file");
}

bool Flag(const YamlMap& yaml, const std::string& key) {
  const std::string text = yaml.Text(key);
  if (text != "true" && text != "false") {
    throw yaml.Error(key, fmt::format("found {}, expected true or false", Quoted(text)));
  }
  return text == "true";
}

std::string OneOf(const YamlMap& yaml, const std::string& key,
                  const std::vector<std::string>& known) {
  const std::string text = yaml.Text(key);
  if (std::find(known.begin(), known.end(), text) != known.end()) return text;
  throw yaml.Error(key, fmt::format("found {}, expected {}", Quoted(text), fmt::join(known, ", ")));
}

TimeNs Seconds(const YamlMap& yaml, const std::string& key) {
  const auto t_ns = DecimalTime(yaml.Text(key), "s");
  if (!t_ns || !ExpectedWithin(BoundsOf("_ns"), static_cast<double>(*t_ns)).empty()) {
    throw yaml.Error(key, fmt::format("found {}, expected seconds", Quoted(yaml.Text(key))));
  }
  return *t_ns;
}

fs::path PathIn(const YamlMap& yaml, const std::string& key, const fs::path& folder) {
  const fs::path path = yaml.Text(key);
  return path.is_absolute() ? path : (folder / path).lexically_normal();
}

void ReadUnits(const YamlMap& yaml, StreamPlan& stream) {
  for (const auto& kind : yaml.Keys()) {
    const std::string text = yaml.Text(kind);
    const auto unit = ParseUnit(text, kind);
    if (!unit) {
      throw yaml.Error(kind, fmt::format("found {}, expected a unit of time, length, angle, force "
                                         "or moment under its kind",
                                         Quoted(text)));
    }
    stream.units[kind] = unit->name;
  }
}

void ReadTable(const YamlMap& yaml, const fs::path& folder, StreamPlan& stream) {
  if (yaml.Has("file")) stream.file = PathIn(yaml, "file", folder);
  if (yaml.Has("topic")) stream.topic = yaml.Text("topic");
  if (yaml.Has("separator"))
    stream.separator = OneOf(yaml, "separator", {"comma", "semicolon", "tab", "blank"});
  if (yaml.Has("decimal")) stream.decimal = OneOf(yaml, "decimal", {"point", "comma"});
  if (yaml.Has("header")) stream.header = Flag(yaml, "header");
  if (yaml.Has("columns")) {
    const auto columns = yaml.Map("columns");
    for (const auto& role : columns.Keys()) stream.columns[role] = columns.Text(role);
  }
  if (yaml.Has("units")) ReadUnits(yaml.Map("units"), stream);
  if (yaml.Has("orientation")) stream.orientation = yaml.Text("orientation");
  if (yaml.Has("quaternion")) stream.quaternion = OneOf(yaml, "quaternion", {"wxyz", "xyzw"});
  if (yaml.Has("axis")) stream.axis = OneOf(yaml, "axis", {"x", "-x", "y", "-y", "z", "-z"});
  if (yaml.Has("offset_s")) stream.offset_ns = Seconds(yaml, "offset_s");
  RefuseUnknown(yaml);
}

void ReadCamera(const YamlMap& yaml, const fs::path& folder, CameraPlan& camera) {
  if (yaml.Has("video")) camera.video = PathIn(yaml, "video", folder);
  if (yaml.Has("topic")) camera.topic = yaml.Text("topic");
  if (yaml.Has("camera")) camera.camera = PathIn(yaml, "camera", folder);
  if (yaml.Has("pose")) camera.pose = PathIn(yaml, "pose", folder);
  if (yaml.Has("link")) camera.link = Flag(yaml, "link");
  if (yaml.Has("times")) ReadTable(yaml.Map("times"), folder, camera.times);
  if (yaml.Has("start")) camera.start = yaml.Text("start");
  if (yaml.Has("rate_hz")) camera.rate_hz = yaml.Positive("rate_hz");
  if (yaml.Has("offset_s")) camera.offset_ns = Seconds(yaml, "offset_s");
  RefuseUnknown(yaml);
}

void ReadFiles(const YamlMap& yaml, const fs::path& folder, ImportPlan& plan) {
  if (yaml.Has("bags")) {
    plan.bags.clear();
    for (const fs::path file : yaml.Texts("bags")) {
      plan.bags.push_back(file.is_absolute() ? file : (folder / file).lexically_normal());
    }
  }
  if (yaml.Has("streams")) {
    const auto streams = yaml.Map("streams");
    for (const auto& name : streams.Keys()) {
      if (!IsTableStream(name) && !IsJointStream(name)) {
        throw streams.Error(name, fmt::format("is no stream, expected {}", TableStreamsText()));
      }
      ReadTable(streams.Map(name), folder, plan.streams[name]);
    }
  }
  if (yaml.Has("cameras")) {
    const auto cameras = yaml.Map("cameras");
    for (const auto& name : cameras.Keys()) {
      if (!IsCamera(name)) throw cameras.Error(name, "is no camera, expected cam0 or cam1");
      ReadCamera(cameras.Map(name), folder, plan.cameras[name]);
    }
  }
  if (yaml.Has("collar")) plan.collar = PathIn(yaml, "collar", folder);
  if (yaml.Has("arm")) plan.arm = PathIn(yaml, "arm", folder);
}

void ReadInstrument(const YamlMap& yaml, ImportPlan& plan) {
  const auto take = [&](const char* key, std::optional<double>& value, double number) {
    value = number;
    plan.Told(std::string("instrument.") + key);
  };
  if (yaml.Has("length_m")) take("length_m", plan.length_m, yaml.Positive("length_m"));
  if (yaml.Has("outer_diameter_m"))
    take("outer_diameter_m", plan.outer_diameter_m, yaml.Positive("outer_diameter_m"));
  if (yaml.Has("bending_stiffness_Nm2"))
    take("bending_stiffness_Nm2", plan.bending_stiffness_Nm2,
         yaml.Positive("bending_stiffness_Nm2"));
  if (yaml.Has("mass_per_length_kg_m"))
    take("mass_per_length_kg_m", plan.mass_per_length_kg_m,
         yaml.NonNegative("mass_per_length_kg_m"));
  if (yaml.Has("stiffness_taper"))
    take("stiffness_taper", plan.stiffness_taper, yaml.Number("stiffness_taper"));
  RefuseUnknown(yaml);
}

void ReadSensors(const fs::path& file, const YamlMap& sensors, ImportPlan& plan) {
  for (const auto& stream : sensors.Keys()) {
    const auto settings = sensors.Map(stream);
    for (const auto& key : settings.Keys()) {
      std::string value;
      if (settings.IsList(key)) {
        for (const double number : settings.Numbers(key)) {
          if (!value.empty()) value += ',';
          value += NumberText(number);
        }
      } else {
        value = settings.Text(key);
      }
      TellSensor(plan, file.string(), stream, key, value);
    }
  }
}

void ReadInstrumentKeys(const YamlMap& yaml, ImportPlan& plan) {
  if (yaml.Has("instrument")) ReadInstrument(yaml.Map("instrument"), plan);
  if (yaml.Has("port")) {
    const auto port = yaml.Map("port");
    plan.p_RP = port.Vector3("position_m");
    plan.Told("port.position_m");
    RefuseUnknown(port);
  }
  if (yaml.Has("gravity_m_s2")) {
    plan.gravity_m_s2 = yaml.Vector3("gravity_m_s2");
    plan.Told("gravity_m_s2");
  }
  if (yaml.Has("tolerances")) {
    const auto tolerances = yaml.Map("tolerances");
    for (const auto& key : tolerances.Keys()) {
      plan.tolerances[key] = tolerances.IsList(key) ? tolerances.Numbers(key)
                                                    : std::vector<double>{tolerances.Number(key)};
    }
  }
}

}  // namespace

void ReadMapping(const fs::path& file, ImportPlan& plan) {
  const auto yaml = YamlMap::Load(file);
  const fs::path folder = file.parent_path();
  CheckMappingFormat(yaml);
  ReadFiles(yaml, folder, plan);
  ReadInstrumentKeys(yaml, plan);
  if (yaml.Has("sensors")) ReadSensors(file, yaml.Map("sensors"), plan);
  if (yaml.Has("assumed")) {
    const auto assumed = yaml.Map("assumed");
    for (const auto& key : assumed.Keys()) plan.assumed[key] = assumed.Text(key);
  }
  (void)yaml.Has("comment");
  RefuseUnknown(yaml);
}

}  // namespace flextip::exchange
