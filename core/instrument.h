// The instrument's shaft as every part of flextip knows it.
#pragma once

namespace flextip {

/// Nominal data of a shaft with a circular section.
struct Instrument {
  double length_m = 0.0;  ///< from the wrist pivot to the tip, along the shaft
  double outer_diameter_m = 0.0;
  double bending_stiffness_Nm2 = 0.0;  ///< E I, in the middle where it tapers
  double mass_per_length_kg_m = 0.0;   ///< 0 where self-weight is not modelled
  double stiffness_taper = 0.0;        ///< E I (1 + taper (s / L - 1/2)), s from the wrist

  /// Returns E I (N m2) at `s_m` from the wrist.
  double StiffnessAt(double s_m) const {
    if (stiffness_taper == 0.0) return bending_stiffness_Nm2;
    return bending_stiffness_Nm2 * (1.0 + stiffness_taper * (s_m / length_m - 0.5));
  }
};

}  // namespace flextip
