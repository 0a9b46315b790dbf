// Lengths on the command line: metres, or a number with its unit.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace flextip {

/// Adds an option whose value is a length: "5mm", "0.5cm", "0.005" and "0.005m" are the same. `T`
/// is double, std::optional<double> or a vector of doubles (m).
template <class T>
CLI::Option* AddLength(CLI::App& command, const std::string& name, T& value_m,
                       const std::string& help) {
  const std::map<std::string, double> units{{"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}};
  return command.add_option(name, value_m, help)
      ->transform(CLI::AsNumberWithUnit(units, CLI::AsNumberWithUnit::UNIT_OPTIONAL, "LENGTH"))
      ->type_name("LENGTH");
}

}  // namespace flextip
