#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

/// Without a wrist nothing speaks against an identity: the tips are then the camera's.
void CheckIdentity(const Recording& recording, std::vector<Finding>& findings) {
  const Eigen::Matrix4d T = recording.cam0->calibration.T_RC.Matrix();
  if (recording.wrist0 || (T - Eigen::Matrix4d::Identity()).norm() > 1e-6) return;
  findings.push_back({Severity::kDoubtful, "cam0.identity",
                      "cam0: T_RC is the identity: tips are in the camera's frame C, not in R",
                      "--calibration hand_eye/calibration.yaml, by flextip calibrate hand-eye"});
}

}  // namespace

std::vector<Finding> CheckLimits(const std::set<std::string>& unknown, Recording& recording) {
  std::vector<Finding> findings;
  CheckInstrument(unknown, recording, findings);
  CheckSensors(unknown, recording, findings);
  if (recording.cam0 && recording.cam0->has_T_RC && !unknown.contains("cam0.T_RC"))
    CheckIdentity(recording, findings);
  if (recording.cam0) CheckCamera("cam0", recording.cam0->calibration, findings);
  if (recording.cam1) CheckCamera("cam1", recording.cam1->calibration, findings);
  if (recording.tags0) CheckCollar(recording, findings);
  return findings;
}

}  // namespace flextip::plausibility
