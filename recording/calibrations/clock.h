// A stream's clock as a calibration found it.
#pragma once

#include <optional>
#include <string>

#include "recording/calibrations/file.h"
#include "recording/recording.h"

namespace flextip {

/// The reference's time for the stream's time t is t + offset + rate (t - origin).
struct FoundClock {
  TimeNs offset_ns = 0, origin_ns = 0;
  double rate = 0.0;
  ClockNoise noise;

  TimeNs TimeOf(TimeNs t_ns) const;
};

/// Returns the clock of `stream` ("em0", "cam0"); empty where the calibration has none. The noise
/// is nothing where the calibration has no covariance.
std::optional<FoundClock> ClockIn(const Calibration& calibration, const std::string& stream);

}  // namespace flextip
