// What a number of a file can be at most, by its name: "length_m", "m1_y [Nm]", "em0.intrinsics".
// The bounds are wide enough for a real value in a wrong unit, which the check of a recording then
// names. Beyond them is no instrument, camera, robot or room, but a damaged file; squares and
// products of numbers within them stay finite.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace flextip {

struct Bounds {
  double most = 1e12;    ///< of the number's size, whatever its sign
  double least = 1e-12;  ///< of a number that must be above 0, or is 0 or above it
  const char* unit = "";
};

/// No camera has more; a picture of so many in colour takes 600 MB.
inline constexpr double kMostPixels = 2e8;

/// Returns the bounds by the last part of `name` (parted by dots) that tells a unit or a quantity;
/// empty where none does.
std::optional<Bounds> KnownBoundsOf(std::string_view name);

/// The same, Bounds{} where no part tells.
Bounds BoundsOf(std::string_view name);

/// Returns "-100000 to 100000 m" where `value` is beyond the bounds, else an empty text.
std::string ExpectedWithin(const Bounds& bounds, double value);

/// The same for a number above 0 or, with `zero`, for 0 too.
std::string ExpectedAbove(const Bounds& bounds, double value, bool zero);

}  // namespace flextip
