// A tag's cells seen through a Gaussian blur: how white a point is, with derivatives.
#pragma once

#include <cstdint>
#include <vector>

#include "vision/photometric/normal_table.h"
#include "vision/tags/cells.h"

namespace flextip {

/// The Gaussian's spread on the tag, in cells, and the correlation of its two axes.
struct PatternBlur {
  float sigma_u = 0.2f, sigma_v = 0.2f, rho = 0.0f;
  float inverse_u = 5.0f, inverse_v = 5.0f;  ///< 1 / sigma
  /// In perspective, a blur that is the same all over the picture is not the same on the tag. The
  /// line u = e is (e - u) inverse_u nearness (1 + rate_u (e - middle)) sigmas away from (u, v),
  /// exactly but for second order in the rates. `nearness` is the depth of the tag's middle over
  /// the depth at (u, v).
  float rate_u = 0.0f, rate_v = 0.0f, middle = 0.0f;

  PatternBlur() = default;
  PatternBlur(double su, double sv, double correlation)
      : sigma_u(static_cast<float>(su)),
        sigma_v(static_cast<float>(sv)),
        rho(static_cast<float>(correlation)),
        inverse_u(static_cast<float>(1 / su)),
        inverse_v(static_cast<float>(1 / sv)) {}
};

/// The blurred pattern at a point: whiteness 0 to 1 and its derivatives by u and v.
struct PatternValue {
  float c, c_u, c_v, c_uu, c_uv, c_vv;
  bool flat;  ///< no edge within reach: the derivatives are zero
};

/// The mean of the pattern under a bivariate normal distribution, exact but for the tails beyond
/// 3.5 sigma and the correlation, which enters by the tetrachoric series to its third power (right
/// to 0.0015 for |rho| < 0.4, to 0.006 at 0.6); into the derivatives it enters by the first.
class BlurredPattern {
 public:
  explicit BlurredPattern(const TagCells& tag);

  int Cells() const { return cells_; }
  /// Returns whether no cell within the pattern is unknown.
  bool AllKnown() const { return all_known_; }
  /// A cell's side between black and white, from (u, v) on one cell along u or v.
  struct Edge {
    float u, v;
    bool along_u;
  };
  const std::vector<Edge>& EdgeList() const { return edge_list_; }
  /// Returns the number of cells' sides between black and white.
  int Edges() const { return static_cast<int>(edge_list_.size()); }

  /// Returns the blurred pattern at (u, v), in cells from the pattern's top left corner; `nearness`
  /// as in PatternBlur.
  PatternValue At(float u, float v, const PatternBlur& blur, float nearness = 1.0f) const {
    const float iu = blur.inverse_u * nearness, iv = blur.inverse_v * nearness;
    const Near near_u(u, blur.sigma_u, iu, blur.rate_u, blur.middle);
    const Near near_v(v, blur.sigma_v, iv, blur.rate_v, blur.middle);
    const bool inside = u > -3 && v > -3 && u < last_ && v < last_;
    return inside && near_u.lines <= 1 && near_v.lines <= 1 ? AtOneCrossing(near_u, near_v, blur)
                                                            : AtMany(u, v, blur, nearness);
  }

  /// Returns the colours of the four cells that meet at line `k` of u and line `l` of v, each 1
  /// where white: bit 0 before both lines, bit 1 before that of u, bit 2 before that of v, bit 3
  /// after both. Lines from 5 before the pattern to 5 beyond it.
  int CornerCode(int k, int l) const {
    return codes_[static_cast<std::size_t>(k + kPad) * stride_ + l + kPad];
  }

  /// Returns whether an edge between black and white lies within `reach_u`, `reach_v` cells (less
  /// than one) of the point, along either axis or both.
  bool NearEdge(float u, float v, float reach_u, float reach_v) const {
    const auto cell = [](float at) { return static_cast<int>(at + kPad) - kPad; };
    const int k0 = cell(u - reach_u), k1 = cell(u + reach_u);
    const int l0 = cell(v - reach_v), l1 = cell(v + reach_v);
    const float* a = Column(k0) + kPad;
    const float* b = Column(k1) + kPad;
    return a[l0] != a[l1] || b[l0] != b[l1] || a[l0] != b[l0];
  }

  /// Returns whether all cells within `reach_u`, `reach_v` cells of the point are known.
  bool Known(float u, float v, float reach_u, float reach_v) const;

 private:
  struct Lines;
  static constexpr int kPad = 8;  // cells around the pattern, as their nearest known ones

  // The lines between cells within reach of a place along one axis.
  struct Near {
    int first, lines;
    float inverse;  // 1 / sigma there
    float x;        // the first line's distance in sigmas
    Near(float at, float sigma, float inverse_sigma, float rate, float middle) {
      const float reach = NormalTable::kReach * sigma;
      first = static_cast<int>(at - reach + 2 * kPad) + 1 - 2 * kPad;  // rounds down and adds one
      lines = static_cast<int>(at + reach + 2 * kPad) + 1 - 2 * kPad - first;
      inverse = inverse_sigma * (1 + rate * (static_cast<float>(first) - middle));
      x = (static_cast<float>(first) - at) * inverse;
    }
  };
  PatternValue AtOneCrossing(const Near& u, const Near& v, const PatternBlur& blur) const;
  PatternValue AtMany(float u, float v, const PatternBlur& blur, float nearness) const;
  static void AddCrossing(float density, float x, float y, const PatternBlur& blur,
                          PatternValue& value);
  const float* Column(int k) const { return &white_[static_cast<std::size_t>(k + kPad) * stride_]; }
  void AddCrossings(const Lines& u, const Lines& v, const PatternBlur& blur,
                    PatternValue& value) const;

  int cells_, stride_;
  float last_;                // three cells beyond the pattern
  std::vector<float> white_;  // columns, padded
  std::vector<std::uint8_t> codes_;
  std::vector<Edge> edge_list_;
  std::vector<bool> known_;  // columns, padded
  bool all_known_;           // within the pattern
  const NormalTable* normal_ = &NormalTable::Get();
};

// The addition of a crossing of lines where the two axes are correlated; `density`: the product of
// both axes' densities there times the crossing's colour. Derivatives to the first order in rho.
inline void BlurredPattern::AddCrossing(float density, float x, float y, const PatternBlur& blur,
                                        PatternValue& value) {
  const float rho = blur.rho, su = blur.inverse_u, sv = blur.inverse_v;
  value.c +=
      density * rho * (1 + 0.5f * rho * (x * y + rho * (x * x - 1) * (y * y - 1) * (1.0f / 3)));
  value.c_u += density * rho * x * su;
  value.c_v += density * rho * y * sv;
  value.c_uu += density * rho * (x * x - 1) * su * su;
  value.c_vv += density * rho * (y * y - 1) * sv * sv;
  value.c_uv += density * (1 + rho * x * y) * su * sv;
}

// With at most one line each way there are four cells at most.
inline PatternValue BlurredPattern::AtOneCrossing(const Near& u, const Near& v,
                                                  const PatternBlur& blur) const {
  const float* before = Column(u.first - 1) + v.first - 1 + kPad;
  PatternValue value{before[0], 0, 0, 0, 0, 0, false};
  if (u.lines + v.lines == 0) {
    value.flat = true;
    return value;
  }
  const float* after = before + stride_;
  const float su = u.inverse, sv = v.inverse;
  if (v.lines == 0) {
    const NormalTable::Value n = normal_->At(u.x);
    const float rise = after[0] - before[0];
    value.c = after[0] - n.cdf * rise;
    value.c_u = n.density * rise * su;
    value.c_uu = u.x * value.c_u * su;
    return value;
  }
  if (u.lines == 0) {
    const NormalTable::Value n = normal_->At(v.x);
    const float rise = before[1] - before[0];
    value.c = before[1] - n.cdf * rise;
    value.c_v = n.density * rise * sv;
    value.c_vv = v.x * value.c_v * sv;
    return value;
  }
  const NormalTable::Value nu = normal_->At(u.x), nv = normal_->At(v.x);
  const float rise0 = after[0] - before[0], rise1 = after[1] - before[1];
  const float left = before[1] + nv.cdf * (before[0] - before[1]);
  const float rise = rise1 + nv.cdf * (rise0 - rise1), corner = rise1 - rise0;
  value.c = left + (1 - nu.cdf) * rise;
  value.c_u = nu.density * rise * su;
  value.c_uu = u.x * value.c_u * su;
  value.c_v = nv.density * sv * (before[1] - before[0] + (1 - nu.cdf) * corner);
  value.c_vv = v.x * value.c_v * sv;
  AddCrossing(corner * nu.density * nv.density, u.x, v.x, blur, value);
  return value;
}

}  // namespace flextip
