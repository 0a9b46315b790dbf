// The tables of Gauss collocation on [0, 1]: nodes, weights and integrals of the interpolation
// polynomials (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.7 and II.14).
// Private to kinematics.
#pragma once

#include <array>

namespace flextip::gauss_collocation {

/// The tables of N nodes. A step's error is of the order 2 N + 1.
template <int N>
struct Tables {
  using Row = std::array<double, N>;
  Row node{}, weight{};
  std::array<Row, N> once{};   ///< a_ij: integral to node i of the polynomial of node j
  std::array<Row, N> twice{};  ///< integrated twice
};

/// Returns the Legendre polynomials P_0 to P_N at z.
template <int N>
constexpr std::array<double, N + 1> Legendre(double z) {
  std::array<double, N + 1> P{};
  P[0] = 1.0;
  P[1] = z;
  for (int k = 1; k < N; ++k) P[k + 1] = ((2 * k + 1) * z * P[k] - k * P[k - 1]) / (k + 1);
  return P;
}

template <int N>
constexpr double Slope(double z, const std::array<double, N + 1>& P) {
  return N * (z * P[N] - P[N - 1]) / (z * z - 1.0);
}

/// Returns the roots of P_N, ascending, by Newton with the roots found divided out.
template <int N>
constexpr std::array<double, N> Roots() {
  std::array<double, N> roots{};
  for (int i = 0; i < N; ++i) {
    double z = i == 0 ? -0.9999 : roots[i - 1] + 1e-4;
    for (int step = 0; step < 200; ++step) {
      const auto P = Legendre<N>(z);
      double divided = Slope<N>(z, P);
      for (int j = 0; j < i; ++j) divided -= P[N] / (z - roots[j]);
      z -= P[N] / divided;
    }
    for (int step = 0; step < 3; ++step) {  // without the division, for the last digits
      const auto P = Legendre<N>(z);
      z -= P[N] / Slope<N>(z, P);
    }
    roots[i] = z;
  }
  return roots;
}

template <int N>
constexpr Tables<N> MakeTables() {
  Tables<N> tables;
  const std::array<double, N> roots = Roots<N>();
  for (int j = 0; j < N; ++j) {
    const double z = roots[j], slope = Slope<N>(z, Legendre<N>(z));
    tables.node[j] = 0.5 * (1.0 + z);
    tables.weight[j] = 1.0 / ((1.0 - z * z) * slope * slope);
  }
  // The polynomial of node j is the sum of (2k+1) b_j P_k(z_j) P_k; P_k integrates to
  // (P_k+1 - P_k-1) / (2k+1).
  for (int i = 0; i < N; ++i) {
    const auto Pi = Legendre<N>(roots[i]);
    for (int j = 0; j < N; ++j) {
      const auto Pj = Legendre<N>(roots[j]);
      double sum = 0.0;
      for (int k = 0; k < N; ++k) sum += Pj[k] * (Pi[k + 1] - (k > 0 ? Pi[k - 1] : -1.0));
      tables.once[i][j] = 0.5 * tables.weight[j] * sum;
    }
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      for (int k = 0; k < N; ++k) {
        tables.twice[i][j] += tables.once[i][k] * tables.once[k][j];
      }
    }
  }
  return tables;
}

template <int N>
inline constexpr Tables<N> kTables = MakeTables<N>();

}  // namespace flextip::gauss_collocation
