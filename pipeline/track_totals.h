// What the frames of a run say together, counted as they come.
#pragma once

#include <Eigen/Dense>
#include <string>

#include "recording/tip_score.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

struct TrackTotals {
  long frames = 0, ok = 0, predicted = 0, lost = 0, tags = 0;
  double rms_px = 0.0;          ///< of the corners about the fit; 0 where pixels were fitted
  std::string family = {};      ///< of the collar's tags
  bool camera_has_pose = true;  ///< else the tips are in the camera's frame
  bool has_wrist = true;        ///< the frames are of a recording with wrist0
  TipScore score = {};          ///< of the ok frames, where there is a truth
  /// Frames whose tags were seen and are no measurement (TipDoubt).
  long not_by_wrist = 0, not_by_collar = 0, stood_still = 0;
  double from_wrist_m = 0.0;  ///< mean distance of those not by wrist from where it has the tip
  double steady_part = 0.0;   ///< size of the mean miss over the mean size: 1 where all are alike
};

struct TrackSums {
  long frames = 0, ok = 0, predicted = 0, lost = 0, tags = 0;
  long by_pixels = 0, by_corners = 0;    ///< ok frames by the way the tip was found
  double squared_direction_noise = 0.0;  ///< over ok
  double squared_rms_px = 0.0;           ///< over by_corners
  double squared_noise_grey = 0.0;       ///< over by_pixels
  double seconds = 0.0;                  ///< reading and tracking
  TipScore score, score_predicted;       ///< scores of ok frames, of predicted frames
  long not_by_wrist = 0, not_by_collar = 0, stood_still = 0;
  double from_wrist_m = 0.0;                         ///< summed over not_by_wrist
  Eigen::Vector3d miss_m = Eigen::Vector3d::Zero();  ///< likewise, as a vector in R

  /// Counts a frame.
  void Add(const TipTrack& track);
  /// Scores a frame's tip against the true tip `p_RE` (R, m), as seen by a camera at `T_RC`.
  void Score(const TipTrack& track, const Eigen::Vector3d& p_RE, const Pose& T_RC);

  double DirectionNoise_rad() const;  ///< RMS; 0 where no frame was ok
  double Corners_px() const;          ///< RMS about the fit; 0 where no frame was by corners
  double Noise_grey() const;          ///< RMS; 0 where no frame was by pixels

  /// Returns the totals for a collar of `family`.
  TrackTotals Totals(const std::string& family, bool camera_has_pose, bool has_wrist) const;
};

}  // namespace flextip
