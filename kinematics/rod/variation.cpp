#include "kinematics/rod/variation.h"

#include "kinematics/rod/collocation.h"

namespace flextip {
namespace {

using gauss_collocation::kTables;
using Pair = Eigen::Array2d;

constexpr int kSolutions = 4, kSolutionPairs = kSolutions / 2;

/// The equations of the node values of u, then their right-hand sides: four starts of (u, v).
template <int N>
struct System {
  static constexpr int kRows = 2 * N, kPairs = N + kSolutionPairs;
  Pair rows[kRows][kPairs];

  void Fill(const std::array<RodNode, N>& nodes, double h);
  /// Leaves the solutions in the last columns. No pivots: a trusted step is short against the
  /// lengths on which u changes, so that the matrix is near the unit matrix.
  void Solve();
};

template <int N>
void System<N>::Fill(const std::array<RodNode, N>& nodes, double h) {
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      const RodNode& node = nodes[j];
      const double f = -h * h * kTables<N>.twice[i][j], one = i == j ? 1.0 : 0.0;
      rows[2 * i][j] << one + f * node.k00, f * node.k01;
      rows[2 * i + 1][j] << f * node.k01, one + f * node.k11;
    }
    const double s = h * kTables<N>.node[i];
    rows[2 * i][N] << 1.0, 0.0;
    rows[2 * i][N + 1] << s, 0.0;
    rows[2 * i + 1][N] << 0.0, 1.0;
    rows[2 * i + 1][N + 1] << 0.0, s;
  }
}

template <int N>
void System<N>::Solve() {
  for (int k = 0; k < N; ++k) {
    // Two rows at once: the block on the diagonal becomes the unit matrix.
    Pair *first = rows[2 * k], *second = rows[2 * k + 1];
    const double a = first[k][0], b = first[k][1], c = second[k][0], d = second[k][1];
    const double part = 1.0 / (a * d - b * c);
    const double ia = part * d, ib = -part * b, ic = -part * c, id = part * a;
    for (int p = k + 1; p < kPairs; ++p) {
      const Pair x = first[p], y = second[p];
      first[p] = ia * x + ib * y;
      second[p] = ic * x + id * y;
    }
    for (int i = 2 * k + 2; i < kRows; ++i) {
      const double f = rows[i][k][0], g = rows[i][k][1];
      for (int p = k + 1; p < kPairs; ++p) rows[i][p] -= f * first[p] + g * second[p];
    }
  }
  for (int k = kRows - 3; k >= 0; --k) {
    Pair u = rows[k][N], v = rows[k][N + 1];
    for (int j = k / 2 + 1; j < N; ++j) {
      const double f = rows[k][j][0], g = rows[k][j][1];
      u -= f * rows[2 * j][N] + g * rows[2 * j + 1][N];
      v -= f * rows[2 * j][N + 1] + g * rows[2 * j + 1][N + 1];
    }
    rows[k][N] = u;
    rows[k][N + 1] = v;
  }
}

/// A row of four numbers: one for each start.
struct Four {
  Pair a = Pair::Zero(), b = Pair::Zero();

  void Add(double f, const Four& x) { a += f * x.a, b += f * x.b; }
  Eigen::RowVector4d Vector() const { return {a[0], a[1], b[0], b[1]}; }
};

/// Returns x J y^T.
double Bracket(const Four& x, const Four& y) { return (x.a * y.b - x.b * y.a).sum(); }

}  // namespace

template <int N>
RodMap MapOfStep(const std::array<RodNode, N>& nodes, double h) {
  System<N> system;
  system.Fill(nodes, h);
  system.Solve();

  Four u[2], v[2];                       // what the end adds to the start
  std::array<std::array<Four, 3>, N> G;  // dP/ds of each start at the nodes
  std::array<Four, 3> W;
  for (int i = 0; i < N; ++i) {
    const RodNode& node = nodes[i];
    const Four u0{system.rows[2 * i][N], system.rows[2 * i][N + 1]};
    const Four u1{system.rows[2 * i + 1][N], system.rows[2 * i + 1][N + 1]};
    Four f0, f1;
    f0.Add(node.k00, u0), f0.Add(node.k01, u1);
    f1.Add(node.k01, u0), f1.Add(node.k11, u1);
    const double b = h * kTables<N>.weight[i], left = h * b * (1.0 - kTables<N>.node[i]);
    u[0].Add(left, f0), u[1].Add(left, f1);
    v[0].Add(b, f0), v[1].Add(b, f1);
    for (int r = 0; r < 3; ++r) {
      G[i][r] = Four();
      G[i][r].Add(node.y[r], u0), G[i][r].Add(node.z[r], u1);
      W[r].Add(b, G[i][r]);
    }
  }
  RodMap map;
  map.flow.row(0) += u[0].Vector();
  map.flow.row(1) += u[1].Vector();
  map.flow.row(2) += v[0].Vector();
  map.flow.row(3) += v[1].Vector();
  map.flow(0, 2) += h;
  map.flow(1, 3) += h;
  for (int r = 0; r < 3; ++r) map.way.row(r) = W[r].Vector();
  for (int i = 0; i < N; ++i) {
    std::array<Four, 3> way;  // W at node i over h
    for (int j = 0; j < N; ++j) {
      for (int r = 0; r < 3; ++r) way[r].Add(kTables<N>.once[i][j], G[j][r]);
    }
    const double b = h * h * kTables<N>.weight[i];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) map.way_by_force(r, c) += b * Bracket(G[i][r], way[c]);
    }
  }
  return map;
}

template RodMap MapOfStep<4>(const std::array<RodNode, 4>&, double);
template RodMap MapOfStep<5>(const std::array<RodNode, 5>&, double);
template RodMap MapOfStep<6>(const std::array<RodNode, 6>&, double);
template RodMap MapOfStep<7>(const std::array<RodNode, 7>&, double);
template RodMap MapOfStep<8>(const std::array<RodNode, 8>&, double);

}  // namespace flextip
