// The thesis's Jacobians exactly as printed, mistakes and all; for tests only (docs/errata.md).
#pragma once

#include <Eigen/Dense>
#include <cmath>

namespace flextip {

/// (3.15)-(3.26). `phi` is here the angle of the line from wrist to port, which is not the phi of
/// (3.7).
inline Eigen::Matrix2d PrintedJacobian3(double y_a, double a, double L, double phi, double dX,
                                        double dY) {
  const double gamma = std::atan(y_a / a);
  const double temp1 = 3.0 * L * y_a;
  const double temp2 = (2.0 * a - L) * temp1;
  const double temp3 = (3.0 * L * a + temp2 * y_a) * (a * a + y_a * y_a);
  const double L_meas2 = dX * dX + dY * dY;
  const double s = std::sin(gamma - phi), c = std::cos(gamma - phi);
  Eigen::Matrix2d J;
  J(0, 0) = 1.0 + L * s * (dY / L_meas2 + dX * (temp2 - temp1) / temp3);
  J(0, 1) = L * s * (-dX / L_meas2 + dY * (temp2 - temp1) / temp3);
  J(1, 0) = -L * c * (-dY / L_meas2 + dX * (temp1 - temp2) / temp3);
  J(1, 1) = 1.0 - L * c * (dX / L_meas2 + dY * (temp1 - temp2) / temp3);
  return J;
}

/// (5.30)-(5.35).
inline Eigen::Matrix2d PrintedJacobian5(double y_a, double a, double L, double phi) {
  const double kappa = (2.0 * a - L - 1.0) * y_a / (a + (2.0 * a - L) * y_a * y_a);
  const double k = L / (a * a + y_a * y_a);
  const double s = std::sin(phi), c = std::cos(phi);
  Eigen::Matrix2d J;
  J(0, 0) = 1.0 + k * (y_a + a * kappa) * s;
  J(0, 1) = k * (-a + y_a * kappa) * s;
  J(1, 0) = k * (y_a + a * kappa) * c;
  J(1, 1) = 1.0 - k * (a - y_a * kappa) * c;
  return J;
}

}  // namespace flextip
