// The file that the dVRK's recorder leaves beside a video: the times of its frames.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/time_series.h"

namespace flextip::exchange {

struct SideCar {
  std::vector<TimeNs> t_ns;  ///< of each frame, the stated latency taken off
  TimeNs latency_ns = 0;     ///< as the file states it; 0: it states none
  std::string side_by_side;  ///< LR or RL: both eyes in one frame
};

/// Whether the name ends with .json.
bool IsSideCar(const std::filesystem::path& file);

/// Reads `timestamps_ns`, `timestamps` (s), `timestamps_ms`, or `frames` with `cpu_ts` or `cpu_ns`,
/// as the recorder's versions write them. Throws InputError where there are none, and where they do
/// not increase.
SideCar ReadSideCar(const std::filesystem::path& file);

}  // namespace flextip::exchange
