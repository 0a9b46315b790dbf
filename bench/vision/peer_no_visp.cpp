// For machines without ViSP.
#include "bench/vision/peer.h"

namespace flextip::bench {

std::unique_ptr<VisionPeer> MakeVispPeer(const CameraCalibration&, const TagCollar&, double) {
  return nullptr;
}
std::unique_ptr<VispTracker> MakeVispTracker(const CameraCalibration&, const TagCollar&) {
  return nullptr;
}

}  // namespace flextip::bench
