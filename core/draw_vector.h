// Vectors of random numbers that are the same whatever compiler builds the program.
#pragma once

#include <Eigen/Core>

namespace flextip {

/// Returns N values of `distribution`, drawn from the last component to the first.
///
/// Vector3d(u(rng), u(rng), u(rng)) would not do: C++ leaves the order in which the arguments of a
/// call are evaluated to the compiler, so a seed alone would not say which vector is drawn.
template <int N, class Distribution, class Generator>
Eigen::Matrix<double, N, 1> DrawVector(Distribution& distribution, Generator& generator) {
  Eigen::Matrix<double, N, 1> v;
  for (int i = N - 1; i >= 0; --i) v[i] = distribution(generator);
  return v;
}

}  // namespace flextip
