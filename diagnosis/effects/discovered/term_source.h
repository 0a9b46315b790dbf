// A discovered term as the source file of an effect of one's own, to start from.
#pragma once

#include <string>

#include "diagnosis/effects/discovered/term.h"

namespace flextip::diagnosis {

/// Returns C++ for a class of that effect and a function that makes it ("MakeEmHum" for "em_hum").
/// Amplitudes and offsets are its parameters; what the shape was found to be is constant, but for
/// the frequency of three inputs that swing in time, which is scanned. `name`: lower case, digits
/// and underlines.
std::string EffectSource(const Term& term, const std::string& name);

/// Returns a name for it: "em0_periodic".
std::string EffectNameOf(const Term& term);

}  // namespace flextip::diagnosis
