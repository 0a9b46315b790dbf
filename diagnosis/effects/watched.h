// What the running diagnosis watches for, and the words of its warnings: effects of the catalogue,
// and two offsets that there are nuisances. The one place that has its words.
#pragma once

#include <memory>
#include <span>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

struct WatchedEffect {
  std::unique_ptr<Effect> (*make)();
  /// In plain words, for a line "SAYS: 0.8 UNIT (sd 0.1)"; null: within tolerance only, no cause.
  const char* says = nullptr;
  const char* unit = "";
  double unit_factor = 1.0;  ///< from SI
  int widened = 0;           ///< so many of the first parameters set in; 0: all
  int first = 0, count = 1;  ///< of the parameters that are told: of several, their norm
  /// Not an offset that sets in, but a drift of the parameters told, of this name; null: no drift.
  const char* drift = nullptr;
};

/// What no cause of the table explains; not a row of it.
inline constexpr int kUnknownCause = 100;

/// The EM sensor, or the gages, read the same distance from the truth everywhere.
std::unique_ptr<Effect> MakeEmOffset();
std::unique_ptr<Effect> MakeStrainOffset();

/// Returns the table, in the order of recordings: new rows go to the end.
std::span<const WatchedEffect> WatchedEffects();

}  // namespace flextip::diagnosis
