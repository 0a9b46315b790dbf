#include "exchange/sensor_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/median.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr std::size_t kFewestForNoise = 20;

enum class Kind : std::uint8_t { kPositive, kNotNegative, kTwo, kDistribution, kText };

const std::map<std::string, std::map<std::string, Kind>>& KnownSettings() {
  static const std::map<std::string, Kind> em{
      {"distance_from_tip_m", Kind::kNotNegative},    {"position_noise_m", Kind::kNotNegative},
      {"orientation_noise_rad", Kind::kNotNegative},  {"noise_distribution", Kind::kDistribution},
      {"registration_noise_rad", Kind::kNotNegative}, {"registration_noise_m", Kind::kNotNegative}};
  static const std::map<std::string, std::map<std::string, Kind>> known{
      {"wrist0",
       {{"position_noise_m", Kind::kNotNegative}, {"orientation_noise_rad", Kind::kNotNegative}}},
      {"command0", {}},
      {"em0", em},
      {"em1", em},
      {"strain0", {{"stations_from_wrist_m", Kind::kTwo}, {"moment_noise_Nm", Kind::kNotNegative}}},
      {"load0", {{"force_noise_N", Kind::kNotNegative}}},
      {"cam0", {}},
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

// Returns what was expected where the value does not fit.
std::string Misfit(Kind kind, const std::vector<double>& values) {
  const bool one = values.size() == 1;
  if (kind == Kind::kPositive && !(one && values[0] > 0)) return "a number above 0";
  if (kind == Kind::kNotNegative && !(one && values[0] >= 0)) return "a number not below 0";
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

const std::vector<std::string>& TableStreams() {
  static const std::vector<std::string> streams{"wrist0", "command0", "em0",
                                                "em1",    "strain0",  "load0"};
  return streams;
}

bool IsTableStream(const std::string& stream) {
  return std::find(TableStreams().begin(), TableStreams().end(), stream) != TableStreams().end();
}

std::string TableStreamsText() { return "wrist0, command0, em0, em1, strain0 or load0"; }

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

std::optional<double> MeasuredNoise(const std::vector<Eigen::VectorXd>& values) {
  if (values.size() < kFewestForNoise) return {};
  std::vector<double> squares;
  for (std::size_t i = 3; i < values.size(); ++i) {
    squares.push_back(
        (values[i] - 3 * values[i - 1] + 3 * values[i - 2] - values[i - 3]).squaredNorm());
  }
  // Of n components with deviation s the square is 20 s^2 times a chi-square of n degrees.
  const double n = static_cast<double>(values.front().size());
  const double chi2_median = n * std::pow(1.0 - 2.0 / (9.0 * n), 3);
  const double noise = std::sqrt(Median(squares) / (20.0 * chi2_median));
  if (!(noise > 0)) return {};
  return noise;
}

}  // namespace flextip::exchange
