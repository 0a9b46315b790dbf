// Whether any direction has an angle past a given one beyond 90 degrees: one polynomial's roots.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "control/angle_pencil.h"

namespace flextip {

/// D(x) = det(c (x^2 A^T A + I) + x (A + A^T)) for a level c in (0, 1): positive at all x > 0 if
/// and only if cos(phi) > -c for all directions (`angle_pencil.h`).
class AngleLevel {
 public:
  AngleLevel(const AnglePencil& pencil, double c) noexcept;

  double Value(double x) const noexcept;
  /// True where D has no root in [a, b], 0 < a < b, by Descartes' rule of signs for that interval.
  /// False says nothing.
  bool IsPositive(double a, double b) const noexcept;

 private:
  std::array<double, 7> coefficients_{};  // of x^0 to x^6
};

}  // namespace flextip
