// The words of a found cause.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "diagnosis/effects/watched.h"
#include "diagnosis/running/running_diagnosis.h"

namespace flextip::diagnosis {
namespace {

const WatchedEffect& RowOf(int cause) {
  const auto watched = WatchedEffects();
  FLEXTIP_CHECK(cause >= 0 && cause < static_cast<int>(watched.size()), "a cause of the list");
  return watched[static_cast<std::size_t>(cause)];
}

/// "the port yields more than the model says: 0.81 mm/N (sd 0.10)".
std::string Sized(const SizedCause& sized) {
  if (sized.cause == kUnknownCause) return "the sensors differ as no cause of the list explains";
  const WatchedEffect& row = RowOf(sized.cause);
  const double value = row.unit_factor * sized.value, sd = row.unit_factor * sized.sd;
  // Two digits of the deviation.
  const int decimals =
      sd > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(sd))), 0, 6) : 3;
  return fmt::format("{}: {:.{}f} {} (sd {:.{}f})", row.says, value, decimals, row.unit, sd,
                     decimals);
}

}  // namespace

std::string CauseName(int cause) {
  if (cause == kUnknownCause) return "unknown";
  const WatchedEffect& row = RowOf(cause);
  return row.drift != nullptr ? row.drift : row.make()->Name();
}

std::string Text(const FoundCause& found) {
  if (!found.IsThere()) return "";
  std::string text = Sized(found.likeliest);
  if (found.other.cause >= 0) text += ", or " + Sized(found.other);
  if (found.has_more) text += ", or others";
  std::string names = CauseName(found.likeliest.cause);
  if (found.other.cause >= 0) names += " or " + CauseName(found.other.cause);
  return fmt::format("{} [{}]", text, names);
}

}  // namespace flextip::diagnosis
