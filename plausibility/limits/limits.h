// Stated values that no instrument, camera or collar has.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Checks length, diameter, stiffness, gravity, stations, distances, forces, cameras and the
/// collar, each for itself. Undoes in `recording` the faults with one remedy, so that the rest can
/// still be judged. Subjects in `unknown` ("stiffness", "length") are not judged.
std::vector<Finding> CheckLimits(const std::set<std::string>& unknown, Recording& recording);

/// Returns whether a shaft of `diameter_m` (0: not known) can have the bending stiffness `EI_Nm2`:
/// a modulus between that of a soft tube and twice that of steel.
bool IsShaftsStiffness(double EI_Nm2, double diameter_m);

// The groups, a file each.
/// Checks the shaft's length, diameter and stiffness, and gravity.
void CheckInstrument(const std::set<std::string>& unknown, Recording& recording,
                     std::vector<Finding>& findings);
/// Checks the gages' stations, the size of forces and the EM sensor's distance.
void CheckSensors(const std::set<std::string>& unknown, Recording& recording,
                  std::vector<Finding>& findings);
/// Checks a camera's intrinsics and rotation. A camera whose view then says nothing gets a focal
/// length of 0.
void CheckCamera(const std::string& name, CameraCalibration& camera,
                 std::vector<Finding>& findings);
/// Checks the tags' size, against an instrument's and around the collar.
void CheckCollar(Recording& recording, std::vector<Finding>& findings);

}  // namespace flextip::plausibility
