#include "apps/common/vector_option.h"

#include <algorithm>

#include "recording/text/text.h"

namespace flextip {

std::optional<Eigen::Vector3d> ParseVector(std::string_view text) {
  Eigen::Vector3d value;
  for (int i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return {};
    const auto number = ParseFinite(Trim(text.substr(0, comma)));
    if (!number) return {};
    value[i] = *number;
    text.remove_prefix(std::min(comma, text.size() - 1) + 1);
  }
  return value;
}

CLI::Option* AddVectorOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                             const std::string& description) {
  const auto take = [&value, name](const std::string& text) {
    const auto parsed = ParseVector(text);
    if (!parsed) throw CLI::ValidationError(name, "'" + text + "' is not x,y,z");
    value = *parsed;
  };
  return command.add_option_function<std::string>(name, take, description)->type_name("X,Y,Z");
}

}  // namespace flextip
