#include "exchange/mapping_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "exchange/sensor_settings.h"
#include "exchange/tables/times.h"
#include "exchange/tables/units.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

constexpr int kMappingVersion = 1;

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
  if (!t_ns) {
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
  if (yaml.Has("offset_s")) stream.offset_ns = Seconds(yaml, "offset_s");
  if (yaml.Has("skip_missing")) stream.skip_missing = Flag(yaml, "skip_missing");
  RefuseUnknown(yaml);
}

void ReadVideo(const YamlMap& yaml, const fs::path& folder, VideoPlan& video) {
  if (yaml.Has("file")) video.file = PathIn(yaml, "file", folder);
  if (yaml.Has("camera")) video.camera = PathIn(yaml, "camera", folder);
  if (yaml.Has("collar")) video.collar = PathIn(yaml, "collar", folder);
  if (yaml.Has("pose")) video.pose = PathIn(yaml, "pose", folder);
  if (yaml.Has("without_pose")) video.without_pose = Flag(yaml, "without_pose");
  if (yaml.Has("link")) video.link = Flag(yaml, "link");
  if (yaml.Has("times")) ReadTable(yaml.Map("times"), folder, video.times);
  if (yaml.Has("start")) video.start = yaml.Text("start");
  if (yaml.Has("rate_hz")) video.rate_hz = yaml.Positive("rate_hz");
  if (yaml.Has("offset_s")) video.offset_ns = Seconds(yaml, "offset_s");
  RefuseUnknown(yaml);
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
        for (const double number : settings.Numbers(key))
          value += (value.empty() ? "" : ",") + NumberText(number);
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

std::string Indented(const std::string& text, const std::string& blanks) {
  std::string indented;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin) + 1;
    indented += blanks + text.substr(begin, end - begin);
    begin = end;
  }
  return indented;
}

std::string TextsText(const std::map<std::string, std::string>& texts, bool quoted) {
  std::string text;
  for (const auto& [key, value] : texts) {
    text +=
        fmt::format("{}{}: {}", text.empty() ? "" : ", ", key, quoted ? YamlText(value) : value);
  }
  return "{" + text + "}";
}

std::string TableText(const StreamPlan& stream) {
  std::string text = fmt::format("file: {}\n", YamlText(stream.file.string()));
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{}: {}\n", key, value);
  };
  add("separator", stream.separator);
  add("decimal", stream.decimal);
  if (stream.header) add("header", *stream.header ? "true" : "false");
  if (!stream.columns.empty()) add("columns", TextsText(stream.columns, true));
  if (!stream.units.empty()) add("units", TextsText(stream.units, false));
  add("orientation", stream.orientation);
  add("quaternion", stream.quaternion);
  if (stream.offset_ns) add("offset_s", SecondsText(*stream.offset_ns));
  if (stream.skip_missing) add("skip_missing", "true");
  return text;
}

std::string VideoText(const VideoPlan& video) {
  std::string text = fmt::format("file: {}\n", YamlText(video.file.string()));
  const auto add = [&](const char* key, const fs::path& path) {
    if (!path.empty()) text += fmt::format("{}: {}\n", key, YamlText(path.string()));
  };
  add("camera", video.camera);
  add("collar", video.collar);
  add("pose", video.pose);
  if (video.without_pose) text += "without_pose: true\n";
  if (video.link) text += "link: true\n";
  if (!video.times.file.empty()) text += "times:\n" + Indented(TableText(video.times), "  ");
  add("start", video.start);
  if (video.rate_hz) text += fmt::format("rate_hz: {}\n", YamlNumber(*video.rate_hz));
  if (video.offset_ns) text += fmt::format("offset_s: {}\n", SecondsText(*video.offset_ns));
  return text;
}

std::string InstrumentText(const ImportPlan& plan) {
  std::string text;
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) text += fmt::format("  {}: {}\n", key, YamlNumber(*value));
  };
  add("length_m", plan.length_m);
  add("outer_diameter_m", plan.outer_diameter_m);
  add("bending_stiffness_Nm2", plan.bending_stiffness_Nm2);
  add("mass_per_length_kg_m", plan.mass_per_length_kg_m);
  add("stiffness_taper", plan.stiffness_taper);
  return text.empty() ? "" : "instrument:\n" + text;
}

std::string SensorsText(const ImportPlan& plan) {
  std::string text;
  for (const auto& [stream, settings] : plan.sensors) {
    if (settings.numbers.empty() && settings.texts.empty()) continue;
    text += fmt::format("  {}:\n", stream);
    for (const auto& [key, values] : settings.numbers) {
      text += fmt::format("    {}: {}\n", key,
                          values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values));
    }
    for (const auto& [key, value] : settings.texts) {
      text += fmt::format("    {}: {}\n", key, YamlText(value));
    }
  }
  return text.empty() ? "" : "sensors:\n" + text;
}

}  // namespace

void ReadMapping(const fs::path& file, ImportPlan& plan) {
  const auto yaml = YamlMap::Load(file);
  const fs::path folder = file.parent_path();
  CheckMappingFormat(yaml);
  if (yaml.Has("streams")) {
    const auto streams = yaml.Map("streams");
    for (const auto& name : streams.Keys()) {
      if (!IsTableStream(name)) {
        throw streams.Error(name, fmt::format("is no stream, expected {}", TableStreamsText()));
      }
      ReadTable(streams.Map(name), folder, plan.streams[name]);
    }
  }
  if (yaml.Has("video")) {
    if (!plan.video) plan.video.emplace();
    ReadVideo(yaml.Map("video"), folder, *plan.video);
  }
  ReadInstrumentKeys(yaml, plan);
  if (yaml.Has("sensors")) ReadSensors(file, yaml.Map("sensors"), plan);
  if (yaml.Has("assumed")) {
    const auto assumed = yaml.Map("assumed");
    for (const auto& key : assumed.Keys()) plan.assumed[key] = assumed.Text(key);
  }
  (void)yaml.Has("comment");
  RefuseUnknown(yaml);
}

std::string MappingText(const ImportPlan& plan) {
  std::string text = fmt::format("format: flextip-import\nversion: {}\n", kMappingVersion);
  if (!plan.streams.empty()) text += "streams:\n";
  for (const auto& [name, stream] : plan.streams) {
    text += fmt::format("  {}:\n", name) + Indented(TableText(stream), "    ");
  }
  if (plan.video) text += "video:\n" + Indented(VideoText(*plan.video), "  ");
  text += SensorsText(plan) + InstrumentText(plan);
  const auto vector3 = [](const Eigen::Vector3d& v) { return YamlNumbers({v.x(), v.y(), v.z()}); };
  if (plan.p_RP) text += fmt::format("port:\n  position_m: {}\n", vector3(*plan.p_RP));
  if (plan.gravity_m_s2) text += fmt::format("gravity_m_s2: {}\n", vector3(*plan.gravity_m_s2));
  if (!plan.tolerances.empty()) text += "tolerances:\n";
  for (const auto& [key, values] : plan.tolerances) {
    text += fmt::format("  {}: {}\n", key,
                        values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values));
  }
  if (!plan.assumed.empty()) text += "assumed:\n";
  for (const auto& [key, what] : plan.assumed)
    text += fmt::format("  {}: {}\n", key, YamlText(what));
  return text;
}

}  // namespace flextip::exchange
