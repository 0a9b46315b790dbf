#include "reproduction/printed_jacobian.h"

#include <cmath>

namespace flextip::reproduction {

Eigen::Matrix2d PrintedPlaneJacobian(double a, double y_a, double length_m, double phi,
                                     const Eigen::Vector2d& wrist_to_port) {
  const double dX = wrist_to_port.x(), dY = wrist_to_port.y();
  const double measured2 = wrist_to_port.squaredNorm();                           // (3.26)
  const double gamma = std::atan(y_a / a);                                        // (3.20)
  const double temp1 = 3.0 * length_m * y_a;                                      // (3.21)
  const double temp2 = (2.0 * a - length_m) * temp1;                              // (3.22)
  const double temp3 = (3.0 * length_m * a + temp2 * y_a) * (a * a + y_a * y_a);  // (3.23)
  const double s = length_m * std::sin(gamma - phi), c = length_m * std::cos(gamma - phi);
  Eigen::Matrix2d J;
  J(0, 0) = 1.0 + s * (dY / measured2 + dX * (temp2 - temp1) / temp3);  // (3.16)
  J(0, 1) = s * (-dX / measured2 + dY * (temp2 - temp1) / temp3);       // (3.17)
  J(1, 0) = -c * (-dY / measured2 + dX * (temp1 - temp2) / temp3);      // (3.18)
  J(1, 1) = 1.0 - c * (dX / measured2 + dY * (temp1 - temp2) / temp3);  // (3.19)
  return J;
}

}  // namespace flextip::reproduction
