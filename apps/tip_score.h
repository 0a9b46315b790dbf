// How far tracked tips are from the truth.
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <optional>

#include "core/pose.h"
#include "core/time_series.h"
#include "core/tip_observation.h"

namespace flextip {

/// The true tip positions in R: `file` (columns timestamp [ns], x, y, z; others are ignored) or,
/// where it is empty, RECORDING/truth0; empty where there is none. Throws InputError.
std::optional<Series<Eigen::Vector3d>> ReadTipTruth(const std::filesystem::path& recording,
                                                    const std::filesystem::path& file);

/// Over the frames that were seen (status ok) at times the truth covers.
struct TipScore {
  int frames = 0;
  double rms_error_m = 0.0, max_error_m = 0.0;
  double rms_across_m = 0.0;  ///< across the camera's axis, x and y together
  double rms_depth_m = 0.0;   ///< along it
  double mean_nees = 0.0;     ///< squared error over its covariance: 3 where that is honest
};

TipScore ScoreTips(const Series<TipObservation>& tips, const Series<Eigen::Vector3d>& truth,
                   const Pose& T_RC);

}  // namespace flextip
