// Which view of the board would make a calibration surest.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/uncertainty/projection_uncertainty.h"

namespace flextip {

struct NextViewOptions {
  double depth_m = HUGE_VAL;  ///< where the camera is to measure
  bool worst = false;         ///< by the largest uncertainty in the picture, not by the mean
};

struct NextView {
  Pose T_CB;
  double before_px = 0.0, after_px = 0.0;  ///< mean (or largest) uncertainty, as predicted
  std::string words;                       ///< "hold the board in the upper left, ..."
};

/// Returns places of the board at which all corners would be seen: in nine parts of the picture and
/// at four distances, facing the camera and tilted four ways.
std::vector<Pose> CandidateViews(const CameraSolution& solution,
                                 const std::vector<Eigen::Vector3d>& x_B);

/// Returns the candidates, sorted: the view that lowers the uncertainty most comes first.
std::vector<NextView> RankNextViews(const ProjectionUncertainty& uncertainty,
                                    const std::vector<Pose>& candidates,
                                    const std::vector<Eigen::Vector3d>& x_B,
                                    const NextViewOptions& options);

/// Returns "hold the board in the upper left of the picture, 310 mm away, its left side 40 deg
/// nearer".
std::string HoldTheBoard(const CameraCalibration& camera, const Eigen::Vector3d& centre_B,
                         const Pose& T_CB);

}  // namespace flextip
