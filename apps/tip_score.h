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

/// Over the frames that were seen (status ok) at times the truth covers; sums, so that it can be
/// added to frame by frame.
struct TipScore {
  int frames = 0;
  double squared_m2 = 0.0, squared_depth_m2 = 0.0;  ///< depth: along the camera's axis
  double max_error_m = 0.0;
  double nees = 0.0;

  double RmsError() const;   ///< m
  double RmsAcross() const;  ///< across the camera's axis, x and y together (m)
  double RmsDepth() const;   ///< m
  /// Squared error over its covariance: 3 where that is honest.
  double MeanNees() const;

  void Add(const Sample<TipObservation>& tip, const Series<Eigen::Vector3d>& truth,
           const Pose& T_RC);
};

TipScore ScoreTips(const Series<TipObservation>& tips, const Series<Eigen::Vector3d>& truth,
                   const Pose& T_RC);

}  // namespace flextip
