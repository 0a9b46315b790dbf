// The simulation's truth beside a recording. Only scoring may read it: tests, and the deviations
// that `simulate` reports.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>

#include "core/time_series.h"

namespace flextip {

struct TruthSample {
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_RE = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
};

/// Reads RECORDING/truth0/data.csv; empty where there is none. Throws InputError as ReadRecording
/// does.
std::optional<Series<TruthSample>> ReadTruth(const std::filesystem::path& recording);

/// Writes RECORDING/truth0/.
void WriteTruth(const std::filesystem::path& recording, const Series<TruthSample>& truth);

}  // namespace flextip
