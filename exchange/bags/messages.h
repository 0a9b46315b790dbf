// The ROS messages that are read, ROS 1 and ROS 2 alike.
#pragma once

#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/bags/wire.h"

namespace flextip::exchange {

struct Header {
  TimeNs stamp_ns = 0;
  std::string frame;
};

/// PoseStamped, TransformStamped, WrenchStamped and JointState as numbers.
struct NumbersMessage {
  Header header;
  std::string child;                     ///< the frame that a TransformStamped places
  std::vector<std::string> joints;       ///< their names
  std::vector<double> position, effort;  ///< of joints
  /// x, y, z and the quaternion x, y, z, w of a pose; force x, y, z of a wrench.
  std::vector<double> values;
};

struct ImageMessage {
  Header header;
  int width_px = 0, height_px = 0;
  std::string encoding;  ///< of an Image: "bgr8", ...; of a CompressedImage its format
  bool big_endian = false;
  std::size_t step = 0;  ///< bytes of a line
  Bytes data;            ///< inside the message's bytes
};

struct CameraInfoMessage {
  Header header;
  int width_px = 0, height_px = 0;
  std::string distortion_model;
  std::vector<double> D, K, R, P;
  int binning_x = 0, binning_y = 0;
  bool crops = false;  ///< a region of interest
};

/// Throw WireError.
NumbersMessage ReadPoseStamped(WireReader wire);
NumbersMessage ReadTransformStamped(WireReader wire);
NumbersMessage ReadWrenchStamped(WireReader wire);
NumbersMessage ReadJointState(WireReader wire);
ImageMessage ReadImage(WireReader wire);
ImageMessage ReadCompressedImage(WireReader wire);
CameraInfoMessage ReadCameraInfo(WireReader wire);

}  // namespace flextip::exchange
