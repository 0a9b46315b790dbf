#include "control/supervision/stops.h"

#include <array>

namespace flextip {
namespace {

constexpr std::array<const char*, kStops> kNames{
    "none",        "not_finite", "bad_time",      "stale_wrist",     "stale_tip",
    "source_lost", "tip_jump",   "tip_disagrees", "model_disagrees", "wrist_not_following",
    "port_moved",  "port_depth", "speed",         "acceleration",    "jerk",
    "step",        "workspace",  "fixture",       "force",           "motion_angle",
    "deadline",    "operator",   "tip_astray"};

}  // namespace

const char* Name(Stop stop) { return kNames[static_cast<std::size_t>(stop)]; }

const char* Name(Reaction reaction) {
  constexpr std::array names{"none", "limit", "hold", "fault"};
  return names[static_cast<std::size_t>(reaction)];
}

const char* Name(VotedSensor sensor) {
  constexpr std::array<const char*, kVotedSensors> names{"tip",    "em0",   "em1",
                                                         "strain", "load0", "wrist_orientation"};
  return names[static_cast<std::size_t>(sensor)];
}

}  // namespace flextip
