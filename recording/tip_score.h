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

/// Over frames of one status; sums, so that it can be added to frame by frame.
struct TipScore {
  int frames = 0, inside = 0;                       ///< inside: the error is in its 95 % ellipsoid
  double squared_m2 = 0.0, squared_depth_m2 = 0.0;  ///< depth: along the camera's axis
  double max_error_m = 0.0;
  double nees = 0.0;

  double RmsError() const;   ///< m
  double RmsAcross() const;  ///< across the camera's axis, x and y together (m)
  double RmsDepth() const;   ///< m
  /// Squared error over its covariance: 3 where that is honest.
  double MeanNees() const;
  double ShareInside() const;

  /// The tip's error in R; the covariance must be definite.
  void Add(const TipObservation& tip, const Eigen::Vector3d& p_RE, const Pose& T_RC);
};

/// Over frames seen (ok), at times the truth covers.
TipScore ScoreTips(const Series<TipObservation>& tips, const Series<Eigen::Vector3d>& truth,
                   const Pose& T_RC);

}  // namespace flextip
