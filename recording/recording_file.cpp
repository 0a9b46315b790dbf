#include "recording/recording_file.h"

#include <cmath>

#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip {
namespace {

void CheckFormat(const YamlMap& yaml) {
  if (const auto format = yaml.Text("format"); format != kRecordingFormat) {
    throw yaml.Error("format",
                     fmt::format("found {}, expected {}", Quoted(format), kRecordingFormat));
  }
  if (const auto version = yaml.Integer("version"); version != kRecordingVersion) {
    throw yaml.Error("version", fmt::format("found the unknown version {}, expected {}", version,
                                            kRecordingVersion));
  }
}

Instrument ReadInstrument(const YamlMap& yaml, ReadLog& log) {
  Instrument instrument;
  instrument.length_m = yaml.Positive("length_m");
  instrument.outer_diameter_m = yaml.Positive("outer_diameter_m");
  instrument.bending_stiffness_Nm2 = yaml.Positive("bending_stiffness_Nm2");
  instrument.mass_per_length_kg_m = yaml.NonNegativeOr("mass_per_length_kg_m", 0.0);
  instrument.stiffness_taper = yaml.NumberOr("stiffness_taper", 0.0);
  if (!(std::abs(instrument.stiffness_taper) < 2)) {
    throw yaml.Error("stiffness_taper", fmt::format("found {}, expected above -2 and below 2",
                                                    instrument.stiffness_taper));
  }
  yaml.WarnUnknown(log);
  return instrument;
}

// Each "effect.parameter" has one tolerance, or one for each of its parts.
std::vector<double> ReadTolerance(const YamlMap& yaml, const std::string& key) {
  if (key.find('.') == std::string::npos) {
    throw yaml.Error(key, "expected keys of the form effect.parameter");
  }
  const auto values = yaml.IsList(key) ? yaml.Numbers(key) : std::vector<double>{yaml.Number(key)};
  for (const double value : values) {
    if (value <= 0) throw yaml.Error(key, fmt::format("found {}, expected it above 0", value));
  }
  if (values.empty()) throw yaml.Error(key, "found an empty list, expected a number");
  return values;
}

std::string InstrumentText(const Instrument& instrument) {
  std::string text = "instrument:\n";
  text += fmt::format("  length_m: {}\n", YamlNumber(instrument.length_m));
  text += fmt::format("  outer_diameter_m: {}\n", YamlNumber(instrument.outer_diameter_m));
  text +=
      fmt::format("  bending_stiffness_Nm2: {}\n", YamlNumber(instrument.bending_stiffness_Nm2));
  text += fmt::format("  mass_per_length_kg_m: {}\n", YamlNumber(instrument.mass_per_length_kg_m));
  if (instrument.stiffness_taper != 0) {
    text += fmt::format("  stiffness_taper: {}\n", YamlNumber(instrument.stiffness_taper));
  }
  return text;
}

}  // namespace

Recording ReadRecordingFile(const std::filesystem::path& file, ReadLog& log, bool may_lack_shaft) {
  const auto yaml = YamlMap::Load(file);
  CheckFormat(yaml);
  Recording recording;
  recording.has_shaft = !may_lack_shaft || yaml.Has("instrument") || yaml.Has("port");
  if (recording.has_shaft) {
    recording.instrument = ReadInstrument(yaml.Map("instrument"), log);
    const auto port = yaml.Map("port");
    recording.p_RP = port.Vector3("position_m");
    port.WarnUnknown(log);
  }
  recording.gravity_m_s2 = yaml.Vector3("gravity_m_s2");
  if (yaml.Has("tolerances")) {
    const auto tolerances = yaml.Map("tolerances");
    for (const auto& key : tolerances.Keys()) {
      recording.tolerances[key] = ReadTolerance(tolerances, key);
    }
  }
  (void)yaml.Has("comment");
  yaml.WarnUnknown(log);
  return recording;
}

void WriteRecordingFile(const std::filesystem::path& file, const Recording& recording) {
  const auto vector3 = [](const Eigen::Vector3d& v) { return YamlNumbers({v.x(), v.y(), v.z()}); };
  std::string text = fmt::format("format: {}\nversion: {}\n", kRecordingFormat, kRecordingVersion);
  if (recording.has_shaft) {
    text += InstrumentText(recording.instrument);
    text += fmt::format("port:\n  position_m: {}\n", vector3(recording.p_RP));
  }
  text += fmt::format("gravity_m_s2: {}\n", vector3(recording.gravity_m_s2));
  text += recording.tolerances.empty() ? "tolerances: {}\n" : "tolerances:\n";
  for (const auto& [key, values] : recording.tolerances) {
    text += fmt::format("  {}: {}\n", key,
                        values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values));
  }
  WriteTextFile(file, text);
}

}  // namespace flextip
