// Numbers and names as people read them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "report/diagnose/words.h"
#include "report/unit_suffix.h"

namespace flextip::report {
namespace {

constexpr std::array<UnitSuffix, 15> kSuffixes{{{"_rad_s", "mrad/s", 1e3},
                                                {"_kg_m", "g/m", 1e3},
                                                {"_N_m", "N/m", 1.0},
                                                {"_1_m", "1/m", 1.0},
                                                {"_Nm_rad", "N m/rad", 1.0},
                                                {"_Nm_s", "mN m/s", 1e3},
                                                {"_m_N", "mm/N", 1e3},
                                                {"_m_s", "mm/s", 1e3},
                                                {"_Nm", "mN m", 1e3},
                                                {"_rad", "mrad", 1e3},
                                                {"_hz", "Hz", 1.0},
                                                {"_px", "px", 1.0},
                                                {"_m", "mm", 1e3},
                                                {"_N", "N", 1.0},
                                                {"_s", "ms", 1e3}}};

std::string Spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void Replace(std::string& text, std::string_view from, std::string_view to) {
  if (const auto at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
}

}  // namespace

std::string Percent(double probability) {
  const double percent = 100.0 * probability;
  if (percent > 99.5) return "> 99 %";
  if (percent >= 1.0) return fmt::format("{:.0f} %", percent);
  return percent >= 0.1 ? fmt::format("{:.1f} %", percent) : "< 0.1 %";
}

std::string SpokenHypothesis(const std::string& name) {
  std::string spoken;
  for (const char c : Spaced(name)) spoken += c == '+' ? std::string(" + ") : std::string(1, c);
  return spoken;
}

std::string SpokenChannel(const std::string& channel) {
  std::string name = ShownUnitOf(channel).name;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kNames{
      {{"wrist0 orientation", "wrist direction"},
       {"em0 time", "EM stamps"},
       {"vision0 time", "frames' stamps"},
       {"em0 ", "EM "},
       {"em1 orientation", "port direction"},
       {"strain0 moment", "strain"},
       {"vision0 position", "tip by vision"},
       {"vision0 direction", "tip direction"}}};
  for (const auto& [from, to] : kNames) Replace(name, from, to);
  if (name == "EM orientation") return "EM direction";
  return name;
}

ShownUnit ShownUnitOf(const std::string& parameter) {
  const UnitSuffix* suffix = SuffixOf(parameter, kSuffixes);
  if (suffix == nullptr) return {.name = Spaced(parameter)};
  return {.name = Spaced(parameter.substr(0, parameter.size() - suffix->ending.size())),
          .unit = std::string(suffix->shown),
          .per_si = suffix->factor};
}

std::string Brief(double value) {
  const double size = std::abs(value);
  if (size >= 100.0 && size < 1e6) return fmt::format("{:.0f}", value);
  return fmt::format("{:.3g}", value);
}

std::string WithDeviation(double value, double sd, const std::string& unit) {
  const std::string tail = unit.empty() ? "" : " " + unit;
  if (!(sd > 0.0) || !std::isfinite(sd)) return Brief(value) + tail;
  // One digit of the deviation, two where the first is a 1 or 2 and one would be too coarse.
  const double exponent = std::floor(std::log10(sd));
  const bool coarse = sd / std::pow(10.0, exponent) < 2.95;
  const int digits = std::clamp((coarse ? 1 : 0) - int(exponent), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}{}", value, digits, sd, digits, tail);
}

bool IsOfJoints(const DiagnosedParameter& parameter) {
  return parameter.is_list &&
         (parameter.effect.starts_with("joint_") || parameter.effect.starts_with("servo_") ||
          parameter.effect == "torque_drift");
}

ShownUnit ShownUnitOf(const DiagnosedParameter& parameter, std::size_t i) {
  ShownUnit shown = ShownUnitOf(parameter.name);
  if (!IsOfJoints(parameter) || i >= parameter.joint_turns.size()) return shown;
  const bool turns = parameter.joint_turns[i];
  const std::string& name = parameter.name;
  if (name == "offset" || name == "width" || name == "window" || name == "start") {
    shown.unit = turns ? "mrad" : "mm";
    shown.per_si = 1e3;
  } else if (name == "compliance") {
    shown.unit = turns ? "mrad/Nm" : "mm/N";
    shown.per_si = 1e3;
  } else if (name == "coulomb") {
    shown.unit = turns ? "Nm" : "N";
  } else if (name == "viscous") {
    shown.unit = turns ? "Nm s/rad" : "N s/m";
  }
  return shown;
}

std::string ComponentName(const DiagnosedParameter& parameter, std::size_t i) {
  const std::size_t size = parameter.value.size();
  if (!parameter.is_list) return "";
  if (IsOfJoints(parameter)) {
    if (parameter.name != "drag" && parameter.name != "matrix")
      return "of joint " + std::to_string(i + 1);
    // Off-diagonal entries, row by row: n (n - 1) of them.
    std::size_t others = 1;
    while (others * (others + 1) < size) ++others;
    const std::size_t row = i / others, column = i % others;
    return "of joint " + std::to_string(row + 1) + " by joint " +
           std::to_string(column < row ? column + 1 : column + 2);
  }
  const std::string axes = "xyz";
  if (size == 3) return axes.substr(i, 1);
  if (size == 9) return axes.substr(i / 3, 1) + axes.substr(i % 3, 1);
  if (size == 4 && parameter.effect.starts_with("strain")) {
    constexpr std::array<std::string_view, 4> kGages{"m1 y", "m1 z", "m2 y", "m2 z"};
    return std::string(kGages[i]);
  }
  if (size == 2 && parameter.name.starts_with("curvature")) return i == 0 ? "y" : "z";
  return std::to_string(i + 1);
}

}  // namespace flextip::report
