// Where the pictures have the tip, against where wrist and port have it.
#pragma once

#include <vector>

#include "core/pose.h"
#include "core/time_series.h"
#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// The collar's pose in the camera, a picture.
using CollarPoses = Series<Pose>;  // T_CE

/// Compares the tips of `poses` with the straight shaft's, in R by cam0's T_RC: another place,
/// another distance (tags of another size), another time. Adds to `findings`, which hold those of
/// the recording; a camera that is wrong already is not judged again.
void CheckCollarPlaces(const Recording& recording, const CollarPoses& poses,
                       std::vector<Finding>& findings);

}  // namespace flextip::plausibility
