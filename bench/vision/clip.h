// Short films of a moving collar, for the time of a tracked frame.
#pragma once

#include <string>
#include <vector>

#include "bench/vision/scene.h"
#include "core/image.h"

namespace flextip::bench {

struct ClipCase {
  std::string name;
  int width_px = 1280;
  double step_px = 5;  ///< the way of the collar's middle between two frames, without distortion
  int tags = 0;        ///< in a row along the shaft, facing the camera; 0: a hexagon around
  double tag_px = 45;
  int rows = 1;            ///< of the tags beside one another
  double circle_px = 120;  ///< the radius of the middle's way
  int first = 0;  ///< the number of the first frame: another one gives other poses and noise
};

struct Clip {
  CameraCalibration camera;
  TagCollar collar;
  std::vector<Image> frames;
  std::vector<Pose> T_CE;
};

/// The collar's middle in E.
Eigen::Vector3d ClipMiddle_E();

/// T_CE of a frame. The collar's middle goes round a circle at 0.11 m while the shaft
/// swings, leans and rolls slowly: between two frames by less than 0.05 rad and `step_px`'s angle
/// at the camera together.
Pose ClipPose(const ClipCase& one, int frame);

TagCollar ClipCollar(const ClipCase& one);
Clip MakeClip(const ClipCase& one, int frames);

}  // namespace flextip::bench
