// Draws what a hidden recording holds: the effects present, and everything else a little off.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "simulation/effects/catalogue.h"

namespace flextip::hidden {

/// How far beyond specification, in tolerances: 3 to 5, 8 to 20, 20 to 40. Values stay below what
/// is plausible (a stiffness of 0.6 to 1.5 times the nominal one, 8 mm of port offset, ...).
enum class EffectSize : std::uint8_t { kSubtle, kPlain, kStrong };

struct HiddenLabel {
  std::vector<std::string> present;     ///< catalogue effects and other forms
  simulation::EffectValues parameters;  ///< values of every catalogue effect
};

/// Forms the catalogue lacks: port_grip, taper, shaft_tissue, second_contact, strain_clip. What
/// they need of the scene is set with it (hidden_recording.h).
const std::vector<std::string>& OtherForms();

/// Returns the sensor without which an effect is nowhere to be seen; empty: there is no such one.
std::string SensorOf(const std::string& effect);

struct EffectDraw {
  std::vector<std::string> present = {};  ///< throws InputError for a name that is neither
  EffectSize size = EffectSize::kPlain;
  bool exact = false;    ///< all values but the present effects' are exactly nominal
  bool massless = true;  ///< nominally: then the weight drawn is not negative
  Eigen::Vector3d mean_axis = Eigen::Vector3d::UnitX();  ///< mean axis of the shaft in R, unit
};

/// Absent effects: each number normal with its tolerance as standard deviation, cut off at two
/// tolerances (drawn again), its magnitude where it has no sign. Present ones: of the size's
/// magnitude (a vector's norm; each entry's RMS of the EM gradient), any direction, port and shaft
/// effects at least half across the shaft. Of the gages one to four are off.
HiddenLabel DrawEffects(const EffectDraw& draw, std::mt19937_64& rng);

}  // namespace flextip::hidden
