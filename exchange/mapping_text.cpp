#include <fmt/format.h>

#include "exchange/mapping_file.h"
#include "exchange/values/times.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

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
  std::string text;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{}: {}\n", key, value);
  };
  if (!stream.file.empty()) add("file", YamlText(stream.file.string()));
  if (!stream.topic.empty()) add("topic", YamlText(stream.topic));
  add("separator", stream.separator);
  add("decimal", stream.decimal);
  if (stream.header) add("header", *stream.header ? "true" : "false");
  if (!stream.columns.empty()) add("columns", TextsText(stream.columns, true));
  if (!stream.units.empty()) add("units", TextsText(stream.units, false));
  add("orientation", stream.orientation);
  add("quaternion", stream.quaternion);
  add("axis", stream.axis);
  if (stream.offset_ns) add("offset_s", SecondsText(*stream.offset_ns));
  return text;
}

std::string CameraText(const CameraPlan& camera) {
  std::string text;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{}: {}\n", key, YamlText(value));
  };
  add("video", camera.video.string());
  add("topic", camera.topic);
  add("camera", camera.camera.string());
  add("pose", camera.pose.string());
  if (camera.link) text += "link: true\n";
  if (!camera.times.file.empty()) text += "times:\n" + Indented(TableText(camera.times), "  ");
  add("start", camera.start);
  if (camera.rate_hz) text += fmt::format("rate_hz: {}\n", YamlNumber(*camera.rate_hz));
  if (camera.offset_ns) text += fmt::format("offset_s: {}\n", SecondsText(*camera.offset_ns));
  return text;
}

std::string FilesText(const ImportPlan& plan) {
  std::string text;
  if (!plan.bags.empty()) text += "bags:\n";
  for (const auto& bag : plan.bags) text += fmt::format("  - {}\n", YamlText(bag.string()));
  if (!plan.streams.empty()) text += "streams:\n";
  for (const auto& [name, stream] : plan.streams) {
    text += fmt::format("  {}:\n", name) + Indented(TableText(stream), "    ");
  }
  if (!plan.cameras.empty()) text += "cameras:\n";
  for (const auto& [name, camera] : plan.cameras) {
    text += fmt::format("  {}:\n", name) + Indented(CameraText(camera), "    ");
  }
  if (!plan.collar.empty()) text += fmt::format("collar: {}\n", YamlText(plan.collar.string()));
  if (!plan.arm.empty()) text += fmt::format("arm: {}\n", YamlText(plan.arm.string()));
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

std::string MappingText(const ImportPlan& plan) {
  std::string text = fmt::format("format: flextip-import\nversion: {}\n", kMappingVersion);
  text += FilesText(plan);
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
