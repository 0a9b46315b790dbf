// The lines every sensor.yaml begins with.
#pragma once

#include <string>

#include "recording/text/yaml_map.h"

namespace flextip {

struct SensorHead {
  std::string comment;
  double rate_hz = 0.0;
};

/// `sensor_type` and `comment` may be absent, `rate_hz` not.
inline SensorHead ReadHead(const YamlMap& yaml) {
  (void)yaml.Has("sensor_type");
  return {yaml.TextOr("comment", ""), yaml.Positive("rate_hz")};
}

inline std::string HeadText(const std::string& type, const std::string& comment, double rate_hz) {
  return fmt::format("sensor_type: {}\ncomment: {}\nrate_hz: {}\n", type, YamlText(comment),
                     YamlNumber(rate_hz));
}

}  // namespace flextip
