#include "recording/calibrations/clock.h"

#include <array>
#include <cmath>

namespace flextip {

TimeNs FoundClock::TimeOf(TimeNs t_ns) const {
  return t_ns + offset_ns + std::llround(rate * static_cast<double>(t_ns - origin_ns));
}

std::optional<FoundClock> ClockIn(const Calibration& calibration, const std::string& stream) {
  const auto number = [&](const char* what) -> std::optional<double> {
    const auto found = calibration.numbers.find(stream + what);
    if (found == calibration.numbers.end() || found->second.empty()) return {};
    return found->second.front();
  };
  const auto offset_s = number(".time_offset_s");
  if (!offset_s) return {};
  FoundClock clock;
  clock.offset_ns = std::llround(1e9 * *offset_s);
  clock.rate = number(".time_rate").value_or(0.0);
  clock.origin_ns = std::llround(1e9 * number(".time_origin_s").value_or(0.0));
  clock.noise.origin_ns = clock.origin_ns;
  if (calibration.covariance.size() == 0) return clock;
  const int offset = calibration.RangeOf(stream + ".time_offset_s").first;
  clock.noise.covariance(0, 0) = calibration.covariance(offset, offset);
  if (number(".time_rate")) {
    const int rate = calibration.RangeOf(stream + ".time_rate").first;
    clock.noise.covariance(1, 1) = calibration.covariance(rate, rate);
    clock.noise.covariance(0, 1) = clock.noise.covariance(1, 0) =
        calibration.covariance(offset, rate);
  }
  return clock;
}

}  // namespace flextip
