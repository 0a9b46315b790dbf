// Options that take a vector: --wrist 0.1,-0.2,0.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <optional>
#include <string>
#include <string_view>

namespace flextip {

/// Three finite numbers with commas between; empty where `text` is anything else.
std::optional<Eigen::Vector3d> ParseVector(std::string_view text);

/// Returns metres of "280mm,0,0.1": lengths in m, or with mm, cm or m; empty for anything else.
std::optional<Eigen::Vector3d> ParsePlace(std::string_view text);

/// Adds option `name`, a place X,Y,Z in metres or with units. Anything else is a usage error.
CLI::Option* AddPlaceOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                            const std::string& description);

/// Adds option `name` (x,y,z: three finite numbers). Anything else is a usage error.
CLI::Option* AddVectorOption(CLI::App& command, const std::string& name, Eigen::Vector3d& value,
                             const std::string& description);

}  // namespace flextip
