#include "apps/common/vector_option.h"

#include <algorithm>
#include <array>

#include "recording/text/text.h"

namespace flextip {
namespace {

/// Three numbers with commas between, each by `parse`.
template <class Parse>
std::optional<Eigen::Vector3d> ParseThree(std::string_view text, const Parse& parse) {
  Eigen::Vector3d value;
  for (int i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return {};
    const std::optional<double> number = parse(Trim(text.substr(0, comma)));
    if (!number) return {};
    value[i] = *number;
    text.remove_prefix(std::min(comma, text.size() - 1) + 1);
  }
  return value;
}

std::optional<double> ParseLength(std::string_view text) {
  struct Unit {
    std::string_view name;
    double divide;  ///< exact for powers of ten
  };
  // "mm" before "m", in which it ends.
  for (const Unit& unit : std::array{Unit{"mm", 1e3}, Unit{"cm", 1e2}, Unit{"m", 1.0}}) {
    if (!text.ends_with(unit.name)) continue;
    const auto number = ParseFinite(Trim(text.substr(0, text.size() - unit.name.size())));
    return number ? std::optional(*number / unit.divide) : std::nullopt;
  }
  return ParseFinite(text);
}

template <class Parse>
CLI::Option* AddThree(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                      const std::string& description, const Parse& parse) {
  const auto take = [&value, name, parse](const std::string& text) {
    const std::optional<Eigen::Vector3d> parsed = parse(text);
    if (!parsed) throw CLI::ValidationError(name, "'" + text + "' is not x,y,z");
    value = *parsed;
  };
  return command.add_option_function<std::string>(name, take, description)->type_name("X,Y,Z");
}

}  // namespace

std::optional<Eigen::Vector3d> ParseVector(std::string_view text) {
  return ParseThree(text, [](std::string_view word) { return ParseFinite(word); });
}

std::optional<Eigen::Vector3d> ParsePlace(std::string_view text) {
  return ParseThree(text, ParseLength);
}

CLI::Option* AddVectorOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                             const std::string& description) {
  return AddThree(command, name, value, description, ParseVector);
}

CLI::Option* AddPlaceOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                            const std::string& description) {
  return AddThree(command, name, value, description, ParsePlace);
}

}  // namespace flextip
