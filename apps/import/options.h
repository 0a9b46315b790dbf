// The options of flextip import, as a plan.
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
  std::vector<std::filesystem::path> files;  ///< tables whose stream is to be found
  std::filesystem::path out, map, settings;
  bool force = false;
  std::vector<std::string> streams, units, quaternions, orientations, offsets, columns, sets,
      skip_missing;
  std::optional<double> length_m, diameter_m, stiffness_Nm2, mass_per_length_kg_m;
  std::optional<Eigen::Vector3d> port, gravity;
  // of a video
  std::filesystem::path video, camera, collar, pose, times;
  std::string start;
  std::optional<double> rate_hz;
  bool no_pose = false, link = false;
};

/// Options of every format. `options` must outlive the parsing.
void AddImportOptions(CLI::App& command, ImportOptions& options);
/// Those of a video.
void AddVideoOptions(CLI::App& command, ImportOptions& options);

/// The mapping file, then the settings file, then the options, each in place of those before.
/// Throws InputError.
exchange::ImportPlan PlanOf(const ImportOptions& options);

/// Every file that is read, for OutputFolder.
std::vector<std::filesystem::path> FilesOf(const exchange::ImportPlan& plan,
                                           const ImportOptions& options);

/// The option that tells what a key of the mapping file tells; empty where there is none.
std::string OptionFor(const std::string& key);

}  // namespace flextip
