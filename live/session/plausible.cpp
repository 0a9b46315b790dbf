#include "live/session/plausible.h"

#include <fmt/format.h>

namespace flextip::live {

void RequireIn(const YamlMap& map, const std::string& key, const Plausible& range, double value) {
  if (range.least <= value && value <= range.most) return;
  throw map.Error(key, fmt::format("found {:.6g}, expected {:g} to {:g} {}: is it in another unit?",
                                   value, range.least, range.most, range.unit));
}

double NumberIn(const YamlMap& map, const std::string& key, const Plausible& range) {
  const double value = map.Number(key);
  RequireIn(map, key, range, value);
  return value;
}

double NumberInOr(const YamlMap& map, const std::string& key, const Plausible& range,
                  double fallback) {
  return map.Has(key) ? NumberIn(map, key, range) : fallback;
}

Eigen::Vector3d VectorIn(const YamlMap& map, const std::string& key, const Plausible& range) {
  const Eigen::Vector3d v = map.Vector3(key);
  RequireIn(map, key, range, v.norm());
  return v;
}

}  // namespace flextip::live
