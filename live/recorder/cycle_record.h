// What a cycle was given and said, and when.
#pragma once

#include "live/loop/cycle.h"

namespace flextip::live {

struct CycleRecord {
  CycleInputs inputs;
  CycleOutputs outputs;
  TimeNs due_ns = 0, woke_ns = 0;  ///< when the cycle was to begin, and did (1970)
  TimeNs sent_ns = 0;              ///< when its command was given to the system; 0: none was
};

}  // namespace flextip::live
