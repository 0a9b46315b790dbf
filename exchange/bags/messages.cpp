// The fields stand in the order of the messages' definitions in common_msgs (ROS 1) and
// common_interfaces (ROS 2).
#include "exchange/bags/messages.h"

namespace flextip::exchange {
namespace {

Header TakeHeader(WireReader& wire) {
  if (wire.format() == WireFormat::kRos1) (void)wire.U32();  // seq
  const TimeNs s = wire.format() == WireFormat::kRos1 ? TimeNs{wire.U32()} : TimeNs{wire.I32()};
  const TimeNs ns = wire.U32();
  return {s * 1'000'000'000 + ns, wire.Text()};
}

}  // namespace

NumbersMessage ReadPoseStamped(WireReader wire) {
  NumbersMessage message;
  message.header = TakeHeader(wire);
  message.values = wire.F64s(7);
  return message;
}

NumbersMessage ReadTransformStamped(WireReader wire) {
  NumbersMessage message;
  message.header = TakeHeader(wire);
  message.child = wire.Text();
  message.values = wire.F64s(7);
  return message;
}

NumbersMessage ReadWrenchStamped(WireReader wire) {
  NumbersMessage message;
  message.header = TakeHeader(wire);
  message.values = wire.F64s(3);
  return message;
}

NumbersMessage ReadJointState(WireReader wire) {
  NumbersMessage message;
  message.header = TakeHeader(wire);
  message.joints = wire.Texts();
  message.position = wire.F64s();
  (void)wire.F64s();  // velocity
  message.effort = wire.F64s();
  return message;
}

ImageMessage ReadImage(WireReader wire) {
  ImageMessage message;
  message.header = TakeHeader(wire);
  message.height_px = wire.I32();
  message.width_px = wire.I32();
  message.encoding = wire.Text();
  message.big_endian = wire.U8() != 0;
  message.step = wire.U32();
  message.data = wire.U8s();
  return message;
}

ImageMessage ReadCompressedImage(WireReader wire) {
  ImageMessage message;
  message.header = TakeHeader(wire);
  message.encoding = wire.Text();
  message.data = wire.U8s();
  return message;
}

CameraInfoMessage ReadCameraInfo(WireReader wire) {
  CameraInfoMessage message;
  message.header = TakeHeader(wire);
  message.height_px = wire.I32();
  message.width_px = wire.I32();
  message.distortion_model = wire.Text();
  message.D = wire.F64s();
  message.K = wire.F64s(9);
  message.R = wire.F64s(9);
  message.P = wire.F64s(12);
  message.binning_x = wire.I32();
  message.binning_y = wire.I32();
  const std::uint32_t x = wire.U32(), y = wire.U32(), height = wire.U32(), width = wire.U32();
  message.crops = x != 0 || y != 0 || (width != 0 && static_cast<int>(width) != message.width_px) ||
                  (height != 0 && static_cast<int>(height) != message.height_px);
  return message;
}

}  // namespace flextip::exchange
