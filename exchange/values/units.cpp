#include "exchange/values/units.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

struct KnownUnit {
  Unit unit;
  std::vector<std::string> names;
};

const std::vector<KnownUnit>& KnownUnits() {
  constexpr double kPi = std::numbers::pi;
  static const std::vector<KnownUnit> known{
      {{"length", "m"}, {"m", "meter", "metre", "meters", "metres"}},
      {{"length", "mm", 1, 1e3}, {"mm", "millimeter", "millimetre", "millimeters", "millimetres"}},
      {{"length", "cm", 1, 1e2}, {"cm"}},
      {{"length", "um", 1, 1e6}, {"um", "µm", "μm", "micron"}},
      {{"length", "in", 0.0254, 1}, {"in", "inch"}},
      {{"angle", "rad"}, {"rad", "radian", "radians"}},
      {{"angle", "deg", kPi, 180}, {"deg", "degree", "degrees", "°"}},
      {{"angle", "mrad", 1, 1e3}, {"mrad"}},
      {{"time", "s"}, {"s", "sec", "secs", "second", "seconds"}},
      {{"time", "ms", 1, 1e3}, {"ms", "msec", "millisecond", "milliseconds"}},
      {{"time", "us", 1, 1e6}, {"us", "µs", "μs", "usec", "microsecond", "microseconds"}},
      {{"time", "ns", 1, 1e9}, {"ns", "nsec", "nanosecond", "nanoseconds"}},
      {{"time", "clock"}, {"clock", "iso8601"}},
      {{"force", "N"}, {"n", "newton", "newtons"}},
      {{"force", "mN", 1, 1e3}, {"mn"}},
      {{"force", "kN", 1e3, 1}, {"kn"}},
      {{"moment", "Nm"}, {"nm", "n m", "n.m", "n*m", "n·m"}},
      {{"moment", "mNm", 1, 1e3}, {"mnm"}},
      {{"moment", "Ncm", 1, 1e2}, {"ncm", "n cm", "n.cm", "n*cm", "n·cm"}},
      {{"moment", "Nmm", 1, 1e3}, {"nmm", "n mm", "n.mm", "n*mm", "n·mm"}},
  };
  return known;
}

}  // namespace

std::optional<Unit> ParseUnit(std::string_view text, const std::string& kind) {
  std::string name(Trim(text));
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  for (const KnownUnit& known : KnownUnits()) {
    if (!kind.empty() && known.unit.kind != kind) continue;
    if (std::find(known.names.begin(), known.names.end(), name) != known.names.end()) {
      return known.unit;
    }
  }
  return {};
}

}  // namespace flextip::exchange
