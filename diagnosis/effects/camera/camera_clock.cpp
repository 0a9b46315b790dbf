#include "diagnosis/effects/delay.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class CameraClock : public ClockEffect {
 public:
  CameraClock()
      : ClockEffect("camera_clock", "the camera runs by a clock of its own",
                    sample_input::kCameraDelay) {}
};

}  // namespace

std::unique_ptr<Effect> MakeCameraClock() { return std::make_unique<CameraClock>(); }

}  // namespace flextip::diagnosis
