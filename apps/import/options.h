// The options of flextip import, and the plan that they tell.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exchange/import_plan.h"

namespace flextip {

struct ImportOptions {
  std::string format;                         ///< csv, video, rosbag, mcap, dvrk
  std::vector<std::filesystem::path> inputs;  ///< tables, videos, bags, a session's folder
  std::filesystem::path out, map, settings, collar, arm;
  bool force = false, link = false, no_check = false;
  std::vector<std::string> streams, units, quaternions, orientations, axes, offsets, columns, sets;
  std::vector<std::string> cameras, poses, times, starts;  ///< FILE, or cam1=FILE
  std::optional<double> length_m, diameter_m, stiffness_Nm2, mass_per_length_kg_m, rate_hz;
  std::optional<Eigen::Vector3d> port, gravity;
};

/// Adds the options of every format. `options` must outlive the parsing.
void AddImportOptions(CLI::App& command, ImportOptions& options);

/// The mapping file, then the settings file, then the options, each in place of those before.
/// Throws InputError.
exchange::ImportPlan PlanOf(const ImportOptions& options);

/// Every file that is read, for OutputFolder.
std::vector<std::filesystem::path> InputsOf(const exchange::ImportPlan& plan,
                                            const ImportOptions& options);

/// The option that tells what a key of the mapping file tells; empty where there is none.
std::string OptionFor(const std::string& key);

}  // namespace flextip
