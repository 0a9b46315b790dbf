// A stop in words that a person reads once.
#pragma once

#include <string>

#include "stops/stop_facts.h"

namespace flextip {

/// Returns one sentence: "Held at 3.42 s by tip_disagrees: the camera's tip was 8.1 mm from where
/// EM, strain and wrist put it; the robot was paused at 5.42 s."
std::string SayStop(const StopFacts& facts);

/// Returns the sensor's name for people: "camera", "EM", "strain".
const char* SpokenName(VotedSensor sensor);

}  // namespace flextip
