// The runs that faults are put into: a move, a controller, a suite of sensors.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "simulation/closed_loop/closed_loop.h"

namespace flextip::bench {

/// Moves of the tip: the press into tissue, the thesis's four with 2 N on the tip, and one in free
/// space. The thesis's go out and back at a speed, with ordinary noises; theirs has steps and none.
enum class Move { kPress, kUp, kDown, kAway, kToward, kFree };
inline constexpr int kMoves = 6;
const char* Name(Move move);

enum class Suite { kVision, kVisionEm, kAll };
inline constexpr int kSuites = 3;
const char* Name(Suite suite);  ///< "vision", "vision+em", "vision+em+strain+load"

struct Base {
  Move move = Move::kPress;
  bool fixture = false;  ///< a floor 1 mm beyond the first leg's end
  ControllerKind controller = ControllerKind::kRodTrack;
  Suite suite = Suite::kVision;
  std::uint64_t seed = 1;  ///< of the sensors' noise

  auto operator<=>(const Base&) const = default;
  std::string Text() const;  ///< "press, rod-track, vision"
};

/// What no run may go beyond.
struct Limits {
  RateLimits rates;          ///< of the commanded wrist
  double tip_force_N = 0.0;  ///< of the force on the tip
};
Limits LimitsOf(Move move);

/// Returns the run without fault and supervision. Sensors have the controller's rate: what they say
/// between two cycles nobody hears, and the plant need not be solved there.
simulation::LoopSetup SetupOf(const Base& base);

/// Returns `setup` under a supervisor of that kind with the move's limits, and with what its tip
/// may be beside the path: who runs a coarse controller knows what it needs.
simulation::LoopSetup Supervised(simulation::LoopSetup setup, Move move, double max_deviation_m,
                                 SupervisionKind kind);

}  // namespace flextip::bench
