// A printed board in words, and the distances at which a camera can use it.
#pragma once

#include <string>

#include "calibration/verdict/verdict.h"
#include "core/camera.h"
#include "targets/board/print.h"

namespace flextip {

struct BoardReach {
  double fills_at_m = 0.0;     ///< nearest distance at which the whole board is in the picture
  double readable_to_m = 0.0;  ///< where its smallest part has 2.5 px
};

/// Returns the distances of a board that faces a camera without lens distortion.
BoardReach ReachOf(const BoardFace& face, const CameraCalibration& camera);

/// Returns the head of the page.
CalibrationVerdict JudgeBoard(const std::string& spec, const BoardFace& face,
                              const BoardOnPaper& place, const BoardReach& reach);

}  // namespace flextip
