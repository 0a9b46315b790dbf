// Central differences, for the tests of every Jacobian.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// The Jacobian of `f` at `x` (rows of f(x), columns of x) by central differences of fourth order
/// with step `h`; the error falls as h^4 until rounding, about 1e-16 |f| / h.
template <class F>
Eigen::MatrixXd NumericJacobian(const F& f, const Eigen::VectorXd& x, double h) {
  const Eigen::VectorXd f0 = f(x);
  Eigen::MatrixXd J(f0.size(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const auto at = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd moved = x;
      moved[j] += step;
      return f(moved);
    };
    J.col(j) = (8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h);
  }
  return J;
}

}  // namespace flextip
