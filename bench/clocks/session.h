// Sessions whose streams have clocks of their own: hidden recordings, their times changed.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip::bench {

/// Reference time = t + offset + rate (t - origin) for a stream's time t.
struct TrueClock {
  double offset_s = 0.0, rate = 0.0;
  TimeNs origin_ns = 0;
  /// The offset at another origin.
  double OffsetAt(TimeNs t_ns) const {
    return offset_s + rate * 1e-9 * static_cast<double>(t_ns - origin_ns);
  }
};

struct SessionKind {
  bool fast = true;  ///< MotionKind::kShake, 30 s; else the hidden recordings' own motions, 24 s
  bool effects = false;  ///< two of the effects that delay or bend, and a load; else tolerances
};

struct ClockSession {
  std::string name;  ///< what was drawn, for people
  Recording recording;
  std::map<std::string, TrueClock> clocks;  ///< of em0, vision0, strain0, load0
};

/// Draws a session: every stream but the wrist's is off by -2.5 to 2.5 s at a rate off by up to
/// 100 ppm. Latencies of the sensors count as offset. load0 is there in every second session.
ClockSession DrawSession(const SessionKind& kind, std::uint64_t seed);

}  // namespace flextip::bench
