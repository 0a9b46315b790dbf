#include "live/session/session.h"

#include <cmath>

namespace flextip::live {

const char* Name(StreamName stream) {
  constexpr std::array names{"wrist0", "vision0", "em0", "em1", "strain0", "load0"};
  return names[static_cast<std::size_t>(stream)];
}

TimeNs CameraSetup::TimeOf(TimeNs t_ns) const {
  t_ns -= std::llround(1e9 * latency.value_s);
  for (const FoundClock& clock : clocks) t_ns = clock.TimeOf(t_ns);
  return t_ns;
}

Latency Session::LatencyOf(StreamName stream) const {
  if (const auto& setup = Of(stream)) return setup->latency;
  if (stream != StreamName::kTip || !camera) return {};
  Latency latency = camera->latency;
  if (camera->address) return latency;
  for (const FoundClock& clock : camera->clocks)
    latency.value_s -= 1e-9 * static_cast<double>(clock.offset_ns);
  return latency;
}

double Session::TimeSdOf(StreamName stream, TimeNs t_ns) const {
  const double sd_s = LatencyOf(stream).sd_s;
  const auto with = [&](const auto& of) {
    return of ? std::hypot(sd_s, of->clock.SdAt(t_ns)) : sd_s;
  };
  if (stream == StreamName::kWrist) return with(base.wrist0);
  if (stream == StreamName::kTip) return with(base.vision0);
  if (stream == StreamName::kEm0) return with(base.em0);
  return sd_s;
}

bool Session::DelayIsUnknown() const {
  if (!path || !UsesTipMeasurement(task.controller.kind)) return false;
  return camera && !camera->address && !camera->latency_known;
}

}  // namespace flextip::live
