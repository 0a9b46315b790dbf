#include "apps/common/unit_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "recording/text/text.h"

namespace flextip {
namespace {

struct LengthUnit {
  std::string_view name;
  double divide;  ///< exact for powers of ten
};
// The longest names first: "mm" ends in "m".
constexpr std::array kLengthUnits{LengthUnit{"mm", 1e3}, LengthUnit{"cm", 1e2},
                                  LengthUnit{"um", 1e6}, LengthUnit{"m", 1.0}};

}  // namespace

std::optional<double> ParseLength(std::string_view text) {
  text = Trim(text);
  for (const LengthUnit& unit : kLengthUnits) {
    if (!text.ends_with(unit.name)) continue;
    const auto number = ParseFinite(Trim(text.substr(0, text.size() - unit.name.size())));
    return number ? std::optional(*number / unit.divide) : std::nullopt;
  }
  return ParseFinite(text);
}

std::optional<Eigen::Vector3d> ParsePlace(std::string_view text) {
  Eigen::Vector3d value;
  for (int i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return {};
    const auto number = ParseLength(text.substr(0, comma));
    if (!number) return {};
    value[i] = *number;
    text.remove_prefix(std::min(comma, text.size() - 1) + 1);
  }
  return value;
}

CLI::Validator LengthInAnyUnit() {
  const auto convert = [](std::string& text) -> std::string {
    const auto length = ParseLength(text);
    if (!length)
      return "'" + text + "' is no length, expected metres, or a number with mm, cm or m";
    text = fmt::format("{}", *length);
    return "";
  };
  return CLI::Validator(convert, "");
}

CLI::Option* AddPlaceOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                            const std::string& description) {
  const auto take = [&value, name](const std::string& text) {
    const auto parsed = ParsePlace(text);
    if (!parsed) throw CLI::ValidationError(name, "'" + text + "' is not x,y,z");
    value = *parsed;
  };
  return command.add_option_function<std::string>(name, take, description)->type_name("X,Y,Z");
}

}  // namespace flextip
