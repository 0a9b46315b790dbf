// Eight pixels at a time: arithmetic on eight floats, and the functions of the inner loops.
//
// The vectors are the compiler's own. Without AVX2 they are computed in halves, by the same
// operations in the same order: results do not depend on the processor.
#pragma once

#include <cstdint>
#include <cstring>

#define FLEXTIP_LANES_INLINE [[gnu::always_inline]] inline

namespace flextip::lanes {

constexpr int kLanes = 8;
using F [[gnu::vector_size(32)]] = float;
using I [[gnu::vector_size(32)]] = std::int32_t;

FLEXTIP_LANES_INLINE void Load(const float* from, F& out) { std::memcpy(&out, from, sizeof out); }
FLEXTIP_LANES_INLINE void Store(const F& value, float* to) {
  std::memcpy(to, &value, sizeof value);
}

// Functions give results by reference: a vector as a return value has no fixed convention.
FLEXTIP_LANES_INLINE void Select(const I& mask, const F& yes, const F& no, F& out) {
  out = (F)(((I)yes & mask) | ((I)no & ~mask));
}
FLEXTIP_LANES_INLINE void ToFloat(const I& value, F& out) {
  out = __builtin_convertvector(value, F);
}
/// Rounds toward zero.
FLEXTIP_LANES_INLINE void ToInt(const F& value, I& out) { out = __builtin_convertvector(value, I); }

/// Computes 2^x for x from -126 to 126, right to 3e-7 of it.
FLEXTIP_LANES_INLINE void Exp2(const F& x, F& out) {
  I i;
  ToInt(x + 128.5f, i);
  i -= 128;
  F whole;
  ToFloat(i, whole);
  const F r = x - whole;
  F p = 1.54035304e-4f * r + 1.33335581e-3f;
  p = p * r + 9.61812911e-3f;
  p = p * r + 5.55041087e-2f;
  p = p * r + 2.40226507e-1f;
  p = p * r + 6.93147181e-1f;
  p = p * r + 1.0f;
  out = p * (F)((i + 127) << 23);
}

/// Computes the logarithm to base 2 of a positive normal number, right to 2e-7 (1 + |result|).
FLEXTIP_LANES_INLINE void Log2(const F& x, F& out) {
  constexpr std::int32_t kRootHalf = 0x3f3504f3;
  const I i = (I)x - kRootHalf;
  F e;
  ToFloat(i >> 23, e);
  const F m = (F)((i & 0x7fffff) + kRootHalf);  // 0.71 to 1.41
  const F s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  F p = s2 * (1.0f / 9) + 1.0f / 7;
  p = p * s2 + 1.0f / 5;
  p = p * s2 + 1.0f / 3;
  p = p * s2 + 1.0f;
  out = e + p * s * 2.88539008f;
}

/// Computes the distribution and density that NormalTable has, cut at 3.5 and stretched (Abramowitz
/// and Stegun 26.2.17; right to 3e-7).
FLEXTIP_LANES_INLINE void CutNormal(const F& x, F& cdf, F& density) {
  constexpr float kReach = 3.5f, kTail = 2.326291e-4f, kStretch = 1 / (1 - 2 * kTail);
  F size;
  Select(x < 0.0f, -x, x, size);
  const I within = size < kReach;
  Select(within, size, F{} + kReach, size);
  F e;
  Exp2(size * size * -0.72134752f, e);
  const F phi = e * 0.39894228f;
  const F t = 1.0f / (0.2316419f * size + 1.0f);
  F p = 1.330274429f * t - 1.821255978f;
  p = p * t + 1.781477937f;
  p = p * t - 0.356563782f;
  p = p * t + 0.319381530f;
  F tail = (phi * p * t - kTail) * kStretch;
  Select(within, tail, F{}, tail);
  Select(x < 0.0f, tail, 1.0f - tail, cdf);
  Select(within, phi * kStretch, F{}, density);
}

/// Splits eight pairs into their first and their second parts.
FLEXTIP_LANES_INLINE void LoadPairs(const float* from, F& first, F& second) {
  F a, b;
  Load(from, a);
  Load(from + kLanes, b);
  first = __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
  second = __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
}

FLEXTIP_LANES_INLINE bool Any(const I& mask) {
  std::uint64_t parts[4];
  std::memcpy(parts, &mask, sizeof parts);
  return (parts[0] | parts[1] | parts[2] | parts[3]) != 0;
}

FLEXTIP_LANES_INLINE double Sum(const F& value) {
  float x[kLanes];
  Store(value, x);
  return (double{x[0]} + x[1]) + (double{x[2]} + x[3]) +
         ((double{x[4]} + x[5]) + (double{x[6]} + x[7]));
}

#if defined(__x86_64__)
template <class Work>
__attribute__((target("avx2"))) void RunByAvx2(Work& work) {
  work.Run();
}
#endif

/// Calls `work.Run()`, which is FLEXTIP_LANES_INLINE as is all that it calls, compiled for AVX2
/// where the processor has it.
template <class Work>
void RunWidest(Work& work) {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2");
  if (wide) return RunByAvx2(work);
#endif
  work.Run();
}

}  // namespace flextip::lanes
