// The groups of ways, a file each: for the sources of this folder.
#pragma once

#include <vector>

#include "testdata/broken/broken_recording.h"

namespace flextip::broken {

std::vector<BrokenWay> EmWays();
std::vector<BrokenWay> WristWays();
std::vector<BrokenWay> VisionWays();
std::vector<BrokenWay> CameraWays();
std::vector<BrokenWay> SettingWays();
std::vector<BrokenWay> ForceWays();

}  // namespace flextip::broken
