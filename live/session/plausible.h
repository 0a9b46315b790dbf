// Settings of a session that would be believed: a number in millimetres is found here.
#pragma once

#include <string>

#include "recording/text/yaml_map.h"

namespace flextip::live {

/// What a number is and between which values a set-up of an operating theatre or a laboratory has
/// it.
struct Plausible {
  double least, most;
  const char* unit;
};

inline constexpr Plausible kShaftLength{0.02, 3.0, "m"};
inline constexpr Plausible kDiameter{1e-4, 0.05, "m"};
inline constexpr Plausible kStiffness{1e-6, 1e4, "N m2"};
inline constexpr Plausible kMassPerLength{0.0, 20.0, "kg/m"};
inline constexpr Plausible kGravity{0.0, 20.0, "m/s2"};
inline constexpr Plausible kPlace{0.0, 10.0, "m"};
inline constexpr Plausible kWay{0.0, 1.0, "m"};
inline constexpr Plausible kNoise{0.0, 0.05, "m"};
inline constexpr Plausible kAngleNoise{0.0, 1.0, "rad"};
inline constexpr Plausible kMomentNoise{0.0, 10.0, "N m"};
inline constexpr Plausible kForceNoise{0.0, 100.0, "N"};
inline constexpr Plausible kStep{1e-6, 0.1, "m"};
inline constexpr Plausible kSpeed{1e-5, 1.0, "m/s"};
inline constexpr Plausible kAcceleration{1e-3, 1000.0, "m/s2"};
inline constexpr Plausible kRate{1.0, 5000.0, "Hz"};
inline constexpr Plausible kTime{0.0, 10.0, "s"};
inline constexpr Plausible kStale{0.001, 10.0, "s"};

/// Returns the number of `key`. Throws InputError where it is not plausible.
double NumberIn(const YamlMap& map, const std::string& key, const Plausible& range);
double NumberInOr(const YamlMap& map, const std::string& key, const Plausible& range,
                  double fallback);
/// The same of a vector's length.
Eigen::Vector3d VectorIn(const YamlMap& map, const std::string& key, const Plausible& range);

/// Throws InputError at `key` where `value`, read elsewhere, is not plausible.
void RequireIn(const YamlMap& map, const std::string& key, const Plausible& range, double value);

}  // namespace flextip::live
