// Lengths and angles in the units that people type and read: 600mm, 12deg.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <optional>
#include <string>
#include <string_view>

namespace flextip {

/// Returns metres of "0.6", "0.6m", "60cm", "600mm" or "50um"; empty where `text` is anything else
/// or not finite.
std::optional<double> ParseLength(std::string_view text);

/// Returns metres of "280mm,0,0": three lengths with commas between; empty for anything else.
std::optional<Eigen::Vector3d> ParsePlace(std::string_view text);

/// Turns a length with a unit into metres before CLI11 reads it as a number; refuses anything else.
CLI::Validator LengthInAnyUnit();

/// Adds option `name`, a place X,Y,Z in metres or with units. Anything else is a usage error.
CLI::Option* AddPlaceOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                            const std::string& description);

}  // namespace flextip
