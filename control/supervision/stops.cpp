#include "control/supervision/stops.h"

#include <array>

namespace flextip {
namespace {

struct Entry {
  const char* name;
  std::string_view meaning;
};

constexpr std::array<Entry, kStops> kEntries{{
    {"none", ""},
    {"not_finite", "a sensor or the command is not a finite number"},
    {"bad_time", "a time stands, runs backwards or lies in the future"},
    {"stale_wrist", "the wrist's readings repeat while it should move"},
    {"stale_tip", "there is no new tip, or its figures repeat"},
    {"source_lost", "a sensor that is needed is gone"},
    {"tip_jump", "the tip is not where its last place and the motion since put it"},
    {"tip_disagrees", "the tip and the other sensors cannot be right together"},
    {"model_disagrees", "the sensors together do not fit the instrument"},
    {"wrist_not_following", "the wrist is not where it was commanded to be"},
    {"port_moved", "the port has left its registered place"},
    {"port_depth", "too little shaft before or beyond the port"},
    {"speed", "the command was slowed to the speed limit"},
    {"acceleration", "the command was slowed to the acceleration limit"},
    {"jerk", "the command was slowed to the jerk limit"},
    {"step", "the command was shortened to the largest step"},
    {"workspace", "the goal lies outside the workspace"},
    {"fixture", "the tip is beyond a fixture"},
    {"force", "the tip presses with more than its limit"},
    {"motion_angle", "the tip might move too far beside what is wanted"},
    {"deadline", "cycles took too long"},
    {"operator", "a person said stop"},
}};

}  // namespace

const char* Name(Stop stop) { return kEntries[static_cast<std::size_t>(stop)].name; }

std::string_view Meaning(Stop stop) { return kEntries[static_cast<std::size_t>(stop)].meaning; }

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
