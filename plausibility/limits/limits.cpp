#include "plausibility/limits/limits.h"

namespace flextip::plausibility {

std::vector<Finding> CheckLimits(const std::set<std::string>& unknown, Recording& recording) {
  std::vector<Finding> findings;
  CheckInstrument(unknown, recording, findings);
  CheckSensors(unknown, recording, findings);
  if (recording.cam0) CheckCamera("cam0", recording.cam0->calibration, findings);
  if (recording.cam1) CheckCamera("cam1", recording.cam1->calibration, findings);
  if (recording.tags0) CheckCollar(recording, findings);
  return findings;
}

}  // namespace flextip::plausibility
