#include "diagnosis/effects/delay.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class CameraLatency : public DelayEffect {
 public:
  CameraLatency()
      : DelayEffect("camera_latency", "frames are stamped late", sample_input::kCameraDelay) {}
};

}  // namespace

std::unique_ptr<Effect> MakeCameraLatency() { return std::make_unique<CameraLatency>(); }

}  // namespace flextip::diagnosis
