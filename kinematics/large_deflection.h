// A cantilever under an end force square to its root, bent far: Belendez, Neipp and Belendez,
// European Journal of Physics 23 (2002). The thesis's (5.18) misprints it (docs/errata.md).
#pragma once

namespace flextip {

/// Place and slope of the free end, in units of the cantilever's length, seen from its root.
struct Cantilever {
  double phi_end_rad = 0.0;  ///< slope of the free end
  double reach = 1.0;        ///< along the root's direction
  double deflection = 0.0;   ///< across it, toward the force
};

/// Largest load that BendCantilever follows: the free end is then turned by about 82 degrees. A
/// larger load gives this one's shape.
inline constexpr double kMaxCantileverLoad = 5.0;

/// Returns the bent cantilever for the load parameter alpha = F l^2 / (2 EI) of (5.16), at least
/// zero.
Cantilever BendCantilever(double alpha) noexcept;

/// Returns the distance (m) of wrist and tip of a shaft of length `length` (m) bent by F = F_p/EI
/// (1/m^2, either sign) at `a` (m) from the wrist: two cantilevers back to back, rooted at the port
/// (5.14)-(5.21). The thesis adds their reaches (5.19), which holds for a = L/2; here their unequal
/// deflections count too.
double BentChord(double F, double a, double length) noexcept;

}  // namespace flextip
