#include "exchange/streams/sensor_settings.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>

#include "exchange/streams/names.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

enum class Kind : std::uint8_t {
  kPositive,
  kNotNegative,
  kTwo,
  kNotNegatives,
  kDistribution,
  kText
};

using SettingKinds = std::map<std::string, Kind>;

const std::map<std::string, SettingKinds>& KnownSettings() {
  static const SettingKinds em{
      {"distance_from_tip_m", Kind::kNotNegative},    {"position_noise_m", Kind::kNotNegative},
      {"orientation_noise_rad", Kind::kNotNegative},  {"noise_distribution", Kind::kDistribution},
      {"registration_noise_rad", Kind::kNotNegative}, {"registration_noise_m", Kind::kNotNegative}};
  static const std::map<std::string, SettingKinds> known{
      {"wrist0",
       {{"position_noise_m", Kind::kNotNegative}, {"orientation_noise_rad", Kind::kNotNegative}}},
      {"command0", {}},
      {"em0", em},
      {"em1", em},
      {"strain0", {{"stations_from_wrist_m", Kind::kTwo}, {"moment_noise_Nm", Kind::kNotNegative}}},
      {"load0", {{"force_noise_N", Kind::kNotNegative}}},
      {"joints0", {{"joint_noise", Kind::kNotNegatives}}},
      {"joints_command0", {{"joint_noise", Kind::kNotNegatives}}},
      {"torque0", {{"torque_noise", Kind::kNotNegatives}}},
  };
  return known;
}

std::optional<std::vector<double>> ParseList(std::string_view text) {
  std::vector<double> values;
  while (true) {
    const auto comma = text.find(',');
    const auto value = ParseFinite(Trim(text.substr(0, comma)));
    if (!value) return {};
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

// Returns what was expected where the values do not fit.
std::string Misfit(Kind kind, const std::vector<double>& values) {
  const bool one = values.size() == 1;
  bool negative = false;
  for (const double value : values) negative = negative || value < 0;
  if (kind == Kind::kPositive && !(one && values[0] > 0)) return "a number above 0";
  if (kind == Kind::kNotNegative && !(one && !negative)) return "a number not below 0";
  if (kind == Kind::kNotNegatives && negative) return "numbers not below 0";
  if (kind == Kind::kTwo && values.size() != 2) return "two numbers";
  return "";
}

Kind KindOf(const std::string& where, const std::string& stream, const std::string& key) {
  const auto settings = KnownSettings().find(stream);
  if (settings == KnownSettings().end()) {
    throw InputError(fmt::format("{}: found the stream {}, expected {}", where, Quoted(stream),
                                 TableStreamsText()));
  }
  if (key == "rate_hz") return Kind::kPositive;
  if (key == "comment") return Kind::kText;
  const auto found = settings->second.find(key);
  if (found != settings->second.end()) return found->second;
  std::string names = "comment, rate_hz";
  for (const auto& [name, kind] : settings->second) names += ", " + name;
  throw InputError(fmt::format("{}: {} has no setting {}, expected one of {}", where, stream,
                               Quoted(key), names));
}

}  // namespace

void TellSensor(ImportPlan& plan, const std::string& where, const std::string& stream,
                const std::string& key, const std::string& value) {
  const Kind kind = KindOf(where, stream, key);
  const auto refuse = [&](const std::string& expected) {
    throw InputError(fmt::format("{}: {}.{}: found {}, expected {}", where, stream, key,
                                 Quoted(value), expected));
  };
  plan.Told(stream + "." + key);
  SensorSettings& settings = plan.sensors[stream];
  if (kind == Kind::kText || kind == Kind::kDistribution) {
    if (kind == Kind::kDistribution && value != "gaussian" && value != "uniform") {
      refuse("gaussian or uniform");
    }
    settings.texts[key] = value;
    return;
  }
  const auto values = ParseList(value);
  if (!values) refuse(kind == Kind::kTwo ? "two numbers" : "a number");
  if (const std::string misfit = Misfit(kind, *values); !misfit.empty()) refuse(misfit);
  settings.numbers[key] = *values;
}

void NeedSettings(const ImportPlan& plan) {
  std::vector<Missing> missing;
  const auto need = [&](const std::string& stream, const std::string& key, const char* meaning) {
    if (!plan.streams.contains(stream)) return;
    const auto told = plan.sensors.find(stream);
    if (told != plan.sensors.end() && told->second.numbers.contains(key)) return;
    missing.push_back({fmt::format("no file says {}.{}, {}", stream, key, meaning),
                       {fmt::format("sensors.{}.{}", stream, key)}});
  };
  need("em0", "distance_from_tip_m", "how far from the tip the sensor sits");
  need("strain0", "stations_from_wrist_m", "where the two pairs of gages sit");
  if (!missing.empty()) throw NotTold(std::move(missing));
}

}  // namespace flextip::exchange
