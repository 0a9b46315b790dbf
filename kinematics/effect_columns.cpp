#include "kinematics/effect_columns.h"

#include <array>

namespace flextip::effect_flow {
namespace {

/// Columns are carried in blocks whose sums stay in registers: the compiler's vectors, a number for
/// each column of a block. (Sanitizers check each as one access, arrays of Eigen as several.)
using TwoColumns [[gnu::vector_size(2 * sizeof(double))]] = double;
using FourColumns [[gnu::vector_size(4 * sizeof(double))]] = double;

/// A vector for each column of a block.
template <class Lane>
struct Lanes {
  static constexpr int kBlock = sizeof(Lane) / sizeof(double);
  Lane x{}, y{}, z{};

  static Lanes Load(const ColumnMatrix& from, int first) {
    Lanes v;
    for (int i = 0; i < kBlock; ++i) {
      v.x[i] = from(0, first + i), v.y[i] = from(1, first + i), v.z[i] = from(2, first + i);
    }
    return v;
  }
  void Store(ColumnMatrix& to, int first) const {
    for (int i = 0; i < kBlock; ++i) {
      to(0, first + i) = x[i], to(1, first + i) = y[i], to(2, first + i) = z[i];
    }
  }
  void AddCross(const Eigen::Vector3d& a, const Lanes& v) {
    x += a.y() * v.z - a.z() * v.y;
    y += a.z() * v.x - a.x() * v.z;
    z += a.x() * v.y - a.y() * v.x;
  }
  void SubtractCross(const Eigen::Vector3d& a, const Lanes& v) {
    x += a.z() * v.y - a.y() * v.z;
    y += a.x() * v.z - a.z() * v.x;
    z += a.y() * v.x - a.x() * v.y;
  }
  void AddTimes(const Eigen::Vector3d& a, const Lane& f) {
    x += a.x() * f, y += a.y() * f, z += a.z() * f;
  }
  Lanes operator*(double f) const { return {f * x, f * y, f * z}; }
  Lanes operator-(const Lanes& v) const { return {x - v.x, y - v.y, z - v.z}; }
  /// Multiplies by u and adds v: one step of Horner's rule.
  void Horner(double u, const Lanes& v) { x = u * x + v.x, y = u * y + v.y, z = u * z + v.z; }
};

/// The series of one block of columns over one step; `w` is turn x t, the change of t.
template <class Lane>
struct BlockSeries {
  using Block = Lanes<Lane>;
  std::array<Block, kColumnOrder + 1> turn, m;
  std::array<Block, kColumnOrder> w;

  void Expand(const FlowStep& step, const Eigen::Vector3d& q, const Block& dn0, const Block& dq,
              const Lane& dky, const Lane& dkz);
  void At(double u, Block& turn_at, Block& m_at, Block& P_at) const;
};

template <class Lane>
inline void BlockSeries<Lane>::Expand(const FlowStep& step, const Eigen::Vector3d& q,
                                      const Block& dn0, const Block& dq, const Lane& dky,
                                      const Lane& dkz) {
  Block dc;
  for (int k = 0; k < kColumnOrder; ++k) {
    dc = m[k] * (1.0 / step.g0) - dc * (step.g1 / step.g0);
    Block change, turn_next = dc, m_next;
    for (int j = 0; j <= k; ++j) {
      change.SubtractCross(step.t[k - j], turn[j]);
      turn_next.AddCross(step.c[k - j], turn[j]);
    }
    turn_next.AddTimes(step.y[k], dky);
    turn_next.AddTimes(step.z[k], dkz);
    m_next.SubtractCross(step.t[k], dn0);
    m_next.AddCross(step.n0, change);
    if (k > 0) {
      m_next.AddCross(step.t[k - 1], dq);
      m_next.SubtractCross(q, w[k - 1]);
    }
    w[k] = change;
    turn[k + 1] = turn_next * (1.0 / (k + 1));
    m[k + 1] = m_next * (1.0 / (k + 1));
  }
}

template <class Lane>
inline void BlockSeries<Lane>::At(double u, Block& turn_at, Block& m_at, Block& P_at) const {
  Block turn_sum = turn[kColumnOrder], m_sum = m[kColumnOrder], P_sum;
  for (int k = kColumnOrder - 1; k >= 0; --k) {
    turn_sum.Horner(u, turn[k]);
    m_sum.Horner(u, m[k]);
    P_sum.Horner(u, w[k] * (1.0 / (k + 1)));
  }
  turn_at = turn_sum;
  m_at = m_sum;
  P_at.x += u * P_sum.x, P_at.y += u * P_sum.y, P_at.z += u * P_sum.z;
}

template <class Lane>
inline void CarryBlocks(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                        FlowColumns& columns, std::span<const double> places, FlowColumns* at) {
  using Block = Lanes<Lane>;
  constexpr int kBlock = Block::kBlock;
  BlockSeries<Lane> series;
  for (int c = first; c < last; c += kBlock) {
    const Block dq = Block::Load(forcing.dq, c);
    Block dn0 = Block::Load(forcing.dn0, c), P = Block::Load(columns.P, c);
    Lane dky, dkz;
    for (int i = 0; i < kBlock; ++i) {
      dky[i] = forcing.dcurvature(0, c + i), dkz[i] = forcing.dcurvature(1, c + i);
    }
    series.turn[0] = Block::Load(columns.turn, c);
    series.m[0] = Block::Load(columns.m, c);
    for (int i = 0; i < path.count; ++i) {
      const FlowStep& step = path.steps[i];
      series.Expand(step, path.load.q, dn0, dq, dky, dkz);
      for (std::size_t j = 0; j < places.size(); ++j) {
        if (places[j] < 0.0 || path.StepOf(places[j]) != i) continue;
        Block turn_at, m_at, P_at = P;
        series.At(places[j] - step.s0, turn_at, m_at, P_at);
        turn_at.Store(at[j].turn, c);
        m_at.Store(at[j].m, c);
        P_at.Store(at[j].P, c);
      }
      series.At(step.h, series.turn[0], series.m[0], P);
      dn0.x -= step.h * dq.x, dn0.y -= step.h * dq.y, dn0.z -= step.h * dq.z;
    }
    series.turn[0].Store(columns.turn, c);
    series.m[0].Store(columns.m, c);
    P.Store(columns.P, c);
  }
}

#ifdef __x86_64__
/// The same for processors with AVX2 and fused multiply-add.
[[gnu::target("avx2,fma")]] void CarryFour(const FlowPath& path, const FlowForcing& forcing,
                                           int first, int last, FlowColumns& columns,
                                           std::span<const double> places, FlowColumns* at) {
  CarryBlocks<FourColumns>(path, forcing, first, last, columns, places, at);
}

bool CarriesFour() {
  static const bool carries =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  return carries;
}
#endif

}  // namespace

void CarryColumns(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                  FlowColumns& columns, std::span<const double> places, FlowColumns* at) {
#ifdef __x86_64__
  if (CarriesFour()) return CarryFour(path, forcing, first, last, columns, places, at);
#endif
  CarryByTwo(path, forcing, first, last, columns, places, at);
}

void CarryByTwo(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                FlowColumns& columns, std::span<const double> places, FlowColumns* at) {
  CarryBlocks<TwoColumns>(path, forcing, first, last, columns, places, at);
}

}  // namespace flextip::effect_flow
