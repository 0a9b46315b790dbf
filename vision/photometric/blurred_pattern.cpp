#include "vision/photometric/blurred_pattern.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr int kMaxLines = 12;

}  // namespace

// The lines between cells within reach along one axis. Line i lies at coordinate first + i; cell k
// of the n + 1 cells beside them ends at line k.
struct BlurredPattern::Lines {
  int first, n;
  float x[kMaxLines], cdf[kMaxLines], density[kMaxLines];
  float weight[kMaxLines + 1];  // of the cells
  float inverse;                // 1 / sigma at the middle line

  Lines(const NormalTable& table, float at, float spread, float inverse_spread, float rate,
        float middle, int low, int high)
      : inverse(inverse_spread * (1 + rate * (at - middle))) {
    const float reach = NormalTable::kReach * spread;
    first = std::max(low, static_cast<int>(std::ceil(at - reach)));
    const int last = std::min(high, static_cast<int>(std::floor(at + reach)));
    n = std::clamp(last - first + 1, 0, kMaxLines);
    if (n == 0) {
      first = std::clamp(static_cast<int>(std::floor(at)) + 1, low, high + 1);
      weight[0] = 1;
      return;
    }
    float before = 0;
    for (int i = 0; i < n; ++i) {
      const auto line = static_cast<float>(first + i);
      x[i] = (line - at) * inverse_spread * (1 + rate * (line - middle));
      const NormalTable::Value value = table.At(x[i]);
      cdf[i] = value.cdf;
      density[i] = value.density;
      weight[i] = cdf[i] - before;
      before = cdf[i];
    }
    weight[n] = 1 - before;
  }

  // First and second derivative, by the position, of the mean of cells of the given values.
  void Derivatives(const float* cell, float& d1, float& d2) const {
    d1 = d2 = 0;
    for (int i = 0; i < n; ++i) {
      const float drop = density[i] * (cell[i + 1] - cell[i]);
      d1 += drop;
      d2 += x[i] * drop;
    }
    d1 *= inverse;
    d2 *= inverse * inverse;
  }
};

BlurredPattern::BlurredPattern(const TagCells& tag)
    : cells_(tag.cells),
      stride_(tag.cells + 2 * kPad),
      last_(static_cast<float>(tag.cells) + 3),
      all_known_(std::none_of(tag.colours.begin(), tag.colours.end(),
                              [](TagCells::Colour c) { return c == TagCells::kUnknown; })) {
  white_.resize(static_cast<std::size_t>(stride_) * stride_);
  known_.resize(white_.size());
  for (int k = -kPad; k < cells_ + kPad; ++k) {
    for (int l = -kPad; l < cells_ + kPad; ++l) {
      const std::size_t at = static_cast<std::size_t>(k + kPad) * stride_ + l + kPad;
      const auto nearest = tag.At(std::clamp(k, 0, cells_ - 1), std::clamp(l, 0, cells_ - 1));
      white_[at] = nearest == TagCells::kWhite ? 1.0f : 0.0f;
      known_[at] = tag.At(k, l) != TagCells::kUnknown;
    }
  }
  codes_.resize(white_.size());
  for (int k = 1 - kPad; k < cells_ + kPad; ++k) {
    for (int l = 1; l < stride_; ++l) {
      const float *before = Column(k - 1) + l - 1, *after = Column(k) + l - 1;
      codes_[static_cast<std::size_t>(k + kPad) * stride_ + l] =
          static_cast<std::uint8_t>(before[0] + 2 * before[1] + 4 * after[0] + 8 * after[1]);
      const auto u = static_cast<float>(k), v = static_cast<float>(l - kPad);
      if (before[1] != after[1]) edge_list_.push_back({u, v, false});
      if (after[0] != after[1]) edge_list_.push_back({u, v, true});
    }
  }
}

PatternValue BlurredPattern::AtMany(float at_u, float at_v, const PatternBlur& blur,
                                    float nearness) const {
  const int low = 1 - kPad, high = cells_ + kPad - 1;
  const Lines u(*normal_, at_u, blur.sigma_u, blur.inverse_u * nearness, blur.rate_u, blur.middle,
                low, high),
      v(*normal_, at_v, blur.sigma_v, blur.inverse_v * nearness, blur.rate_v, blur.middle, low,
        high);
  PatternValue value{0, 0, 0, 0, 0, 0, false};
  if (u.n == 0 && v.n == 0) {
    value.c = Column(u.first - 1)[v.first - 1 + kPad];
    value.flat = true;
    return value;
  }
  float column[kMaxLines + 1], row[kMaxLines + 1] = {};
  for (int k = 0; k <= u.n; ++k) {
    const float* cell = Column(u.first - 1 + k) + v.first - 1 + kPad;
    float sum = 0;
    for (int l = 0; l <= v.n; ++l) {
      sum += v.weight[l] * cell[l];
      row[l] += u.weight[k] * cell[l];
    }
    column[k] = sum;
    value.c += u.weight[k] * sum;
  }
  u.Derivatives(column, value.c_u, value.c_uu);
  v.Derivatives(row, value.c_v, value.c_vv);
  AddCrossings(u, v, blur, value);
  return value;
}

// The pattern is a sum of quarter planes, one at each crossing of lines, and the mean of a quarter
// plane is the bivariate normal distribution.
void BlurredPattern::AddCrossings(const Lines& u, const Lines& v, const PatternBlur& blur,
                                  PatternValue& value) const {
  for (int i = 0; i < u.n; ++i) {
    const float* before = Column(u.first - 1 + i) + v.first - 1 + kPad;
    const float* after = before + stride_;
    for (int j = 0; j < v.n; ++j) {
      const float corner = before[j] - before[j + 1] - after[j] + after[j + 1];
      if (corner == 0) continue;
      AddCrossing(corner * u.density[i] * v.density[j], u.x[i], v.x[j], blur, value);
    }
  }
}

bool BlurredPattern::Known(float u, float v, float reach_u, float reach_v) const {
  if (all_known_) {
    const auto end = static_cast<float>(cells_);
    return u - reach_u >= 0 && v - reach_v >= 0 && u + reach_u < end && v + reach_v < end;
  }
  const auto cell = [&](float at) {
    return std::clamp(static_cast<int>(std::floor(at)), -kPad, cells_ + kPad - 1);
  };
  for (int k = cell(u - reach_u); k <= cell(u + reach_u); ++k) {
    for (int l = cell(v - reach_v); l <= cell(v + reach_v); ++l) {
      if (!known_[static_cast<std::size_t>(k + kPad) * stride_ + l + kPad]) return false;
    }
  }
  return true;
}

}  // namespace flextip
