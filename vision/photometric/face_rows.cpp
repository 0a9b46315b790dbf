#include "vision/photometric/face_rows.h"

#include "vision/photometric/lanes.h"
#include "vision/photometric/pattern_lanes.h"

namespace flextip {
namespace {

using lanes::F, lanes::I, lanes::kLanes;

constexpr int kRow = FaceSums::Rows::kSize;
constexpr int kVectors = 16;                 // of a block of rows that stays in the first cache
constexpr int kBlocksInSinglePrecision = 8;  // then the sums go on in double precision
constexpr float kSaturated_grey = 252.0f;
constexpr float kFarOut_cells = 64.0f;

// A row of derivatives of eight pixels, its weights, and the block it belongs to.
struct Block {
  F row[kRow][kVectors], curvature[kVectors];
  int filled = 0;
};

// Sums of products of columns 4 i to 4 i + 3 and 2 j, 2 j + 1, for the lower triangle.
constexpr int kTilesTall = kRow / 4, kTilesWide = kRow / 2;
struct Products {
  F tile[kTilesTall][kTilesWide][8] = {};
  int blocks = 0;
};

FLEXTIP_LANES_INLINE void Multiply(const Block& block, Products& products) {
  F left[4][kVectors];
  for (int i = 0; i < kTilesTall; ++i) {
    for (int k = 0; k < 4; ++k) {
      for (int n = 0; n < block.filled; ++n) {
        left[k][n] = block.row[4 * i + k][n] * block.curvature[n];
      }
    }
    for (int j = 0; j < 2 * (i + 1); ++j) {
      F* to = products.tile[i][j];
      const F *b0 = block.row[2 * j], *b1 = block.row[2 * j + 1];
      F s00 = to[0], s01 = to[1], s10 = to[2], s11 = to[3];
      F s20 = to[4], s21 = to[5], s30 = to[6], s31 = to[7];
      for (int n = 0; n < block.filled; ++n) {
        const F x = b0[n], y = b1[n];
        s00 += left[0][n] * x, s01 += left[0][n] * y;
        s10 += left[1][n] * x, s11 += left[1][n] * y;
        s20 += left[2][n] * x, s21 += left[2][n] * y;
        s30 += left[3][n] * x, s31 += left[3][n] * y;
      }
      to[0] = s00, to[1] = s01, to[2] = s10, to[3] = s11;
      to[4] = s20, to[5] = s21, to[6] = s30, to[7] = s31;
    }
  }
}

FLEXTIP_LANES_INLINE void Empty(Products& products, FaceSums::Rows& rows) {
  for (int i = 0; i < kTilesTall; ++i) {
    for (int j = 0; j < 2 * (i + 1); ++j) {
      for (int k = 0; k < 8; ++k) {
        rows.A(4 * i + k / 2, 2 * j + k % 2) += lanes::Sum(products.tile[i][j][k]);
        products.tile[i][j][k] = F{};
      }
    }
  }
  products.blocks = 0;
}

// The tone curve and its derivatives: ToneCurve::At.
struct Film {
  F grey, by_light, by_gamma;
};

FLEXTIP_LANES_INLINE void Develop(const F& light, const ToneCurve& tone, Film& film) {
  const auto gamma = static_cast<float>(tone.Gamma());
  const float dark = tone.DarkLight(), inverse = 1 / gamma;
  F inside;
  const I bright = light >= 1.0f, low = light <= dark;
  lanes::Select(low, F{} + dark, light, inside);
  lanes::Select(bright, F{} + 1.0f, inside, inside);
  F log, root;
  lanes::Log2(inside, log);
  lanes::Exp2(log * inverse, root);
  film.grey = 255.0f * root;
  film.by_light = film.grey * inverse / inside;
  film.by_gamma = film.grey * log * (-0.69314718f * inverse * inverse);
  lanes::Select(low, tone.DarkGrey() + tone.DarkSlope() * (light - dark), film.grey, film.grey);
  lanes::Select(low, F{} + tone.DarkSlope(), film.by_light, film.by_light);
  const I plain = low | bright;
  lanes::Select(bright, F{}, film.by_light, film.by_light);
  lanes::Select(plain, F{}, film.by_gamma, film.by_gamma);
}

// RobustRule::Weight and Curvature.
FLEXTIP_LANES_INLINE void Weigh(const F& residual, const RobustRule& rule, F& weight,
                                F& curvature) {
  if (rule.Kind() == Robustness::kHuber) {
    const float scale = rule.Scale();
    F size;
    lanes::Select(residual < 0.0f, -residual, residual, size);
    lanes::Select(size < scale, F{} + scale, size, size);
    weight = curvature = scale / size;
    return;
  }
  const F t = 1.0f - residual * residual * rule.InverseCut2();
  lanes::Select(t > 0.0f, t * t, F{}, weight);
  curvature = weight;
  if (rule.Kind() != Robustness::kTukeyNewton) return;
  const F least = RobustRule::kLeastCurvature * weight, bent = t * (5.0f * t - 4.0f);
  lanes::Select((t > 0.0f) & (bent > least), bent, least, curvature);
}

struct Totals {
  F score[kRow] = {};
  F moments[6] = {};
  F squares = {}, curvature = {};
  I brighter = {}, darker = {};
};

FLEXTIP_LANES_INLINE void AddVector(const FacePixels& pixels, int at, const FaceModel& m,
                                    const BlurredPattern& pattern, const ToneCurve& tone,
                                    const RobustRule& rule, float half_contrast, Block& block,
                                    Totals& totals, FaceSums& sums) {
  F mx, my, grey, part;
  lanes::Load(&pixels.mx[at], mx);
  lanes::Load(&pixels.my[at], my);
  lanes::Load(&pixels.grey[at], grey);
  lanes::Load(&pixels.part[at], part);
  const Eigen::Matrix3f& T = m.to_tag;
  F w = T(2, 0) * mx + T(2, 1) * my + T(2, 2);
  F z = 1.0f / w;
  F u = (T(0, 0) * mx + T(0, 1) * my + T(0, 2)) * z;
  F v = (T(1, 0) * mx + T(1, 1) * my + T(1, 2)) * z;
  // What a stray pose puts out of sight takes no part.
  const I near = (u > -kFarOut_cells) & (u < kFarOut_cells) & (v > -kFarOut_cells) &
                 (v < kFarOut_cells) & (w > 0.0f);
  lanes::Select(near, u, F{}, u);
  lanes::Select(near, v, F{}, v);
  lanes::Select(near, z, F{} + m.depth, z);
  lanes::Select(near, w, F{} + 1 / m.depth, w);
  lanes::Select(near, part, F{}, part);

  lanes::Pattern p;
  lanes::LookUp(u, v, m.depth * w, m.blur, pattern, p);

  const auto& level = m.levels;
  const float inverse_half = 1 / m.half;
  const F fu = u * inverse_half - 1.0f, fv = v * inverse_half - 1.0f;
  const F black = level[0] + level[1] * fu + level[2] * fv;
  const F white = level[3] + level[4] * fu + level[5] * fv;
  const F falloff = 1.0f + m.bend[0] * fu * fu + m.bend[1] * fu * fv + m.bend[2] * fv * fv;
  const F contrast = falloff * (white - black);
  // The light is blurred with the pattern: where it rises, the brighter side counts for more.
  const float uu = m.blur.sigma_u * m.blur.sigma_u, vv = m.blur.sigma_v * m.blur.sigma_v,
              uv = m.blur.rho * m.blur.sigma_u * m.blur.sigma_v;
  const F from_u = uu * p.c_u + uv * p.c_v, from_v = uv * p.c_u + vv * p.c_v;
  const F brighter = ((level[4] - level[1]) * inverse_half) * from_u +
                     ((level[5] - level[2]) * inverse_half) * from_v;
  Film film;
  Develop(falloff * (black + brighter) + p.c * contrast, tone, film);
  const F residual = grey - film.grey;
  lanes::Select((film.by_light == 0.0f) & (grey > kSaturated_grey), F{}, part, part);

  F weight, curvature;
  Weigh(residual, rule, weight, curvature);
  weight *= part;
  curvature *= part;
  const I counts = part > 0.0f;
  totals.brighter -= counts & (residual > half_contrast);
  totals.darker -= counts & (residual < -half_contrast);
  for (int k = 0; k < kLanes; ++k) {
    if (counts[k] != 0) sums.CountError(residual[k]);
  }
  totals.moments[0] += weight;
  totals.moments[1] += weight * film.grey;
  totals.moments[2] += weight * grey;
  totals.moments[3] += weight * film.grey * film.grey;
  totals.moments[4] += weight * grey * grey;
  totals.moments[5] += weight * film.grey * grey;
  const F score = weight * residual;
  totals.squares += score * score;
  totals.curvature += curvature;

  F row[kRow];
  // By the ray, and by the point of the tag that is seen there.
  const F by_c = film.by_light * contrast;
  const F D00 = T(0, 0) - u * T(2, 0), D01 = T(0, 1) - u * T(2, 1);
  const F D10 = T(1, 0) - v * T(2, 0), D11 = T(1, 1) - v * T(2, 1);
  const F gx = by_c * (p.c_u * D00 + p.c_v * D10), gy = by_c * (p.c_u * D01 + p.c_v * D11);
  const F gz = gx * mx + gy * my;
  const F qx = mx * z - m.pivot_C[0], qy = my * z - m.pivot_C[1], qz = z - m.pivot_C[2];
  row[0] = qy * gz + qz * gy;
  row[1] = -qz * gx - qx * gz;
  row[2] = qy * gx - qx * gy;
  row[3] = -gx;
  row[4] = -gy;
  row[5] = gz;
  // Spreading is diffusion: the derivative by a variance is half the second derivative.
  const auto& M = m.m_of_px;
  const F a = z * (D00 * M(0, 0) + D01 * M(1, 0)), b = z * (D00 * M(0, 1) + D01 * M(1, 1));
  const F c = z * (D10 * M(0, 0) + D11 * M(1, 0)), d = z * (D10 * M(0, 1) + D11 * M(1, 1));
  row[6] = 0.5f * by_c * (a * a * p.c_uu + 2.0f * a * c * p.c_uv + c * c * p.c_vv);
  row[7] = by_c * (a * b * p.c_uu + (a * d + c * b) * p.c_uv + c * d * p.c_vv);
  row[8] = 0.5f * by_c * (b * b * p.c_uu + 2.0f * b * d * p.c_uv + d * d * p.c_vv);
  row[9] = film.by_gamma;
  const F by_level = film.by_light * falloff;
  const F by_black = by_level * (1.0f - p.c), by_white = by_level * p.c;
  const F by_u = by_level * from_u * inverse_half, by_v = by_level * from_v * inverse_half;
  row[10] = by_black;
  row[11] = by_black * fu - by_u;
  row[12] = by_black * fv - by_v;
  row[13] = by_white;
  row[14] = by_white * fu + by_u;
  row[15] = by_white * fv + by_v;
  for (int k = 0; k < kRow; ++k) {
    block.row[k][block.filled] = row[k];
    totals.score[k] += row[k] * score;
  }
  block.curvature[block.filled++] = curvature;
}

FLEXTIP_LANES_INLINE void AddAll(const FacePixels& pixels, const FaceModel& model,
                                 const BlurredPattern& pattern, const ToneCurve& tone,
                                 const RobustRule& rule, FaceSums::Rows& rows, FaceSums& sums) {
  Block block;
  Products products;
  Totals totals;
  const float half_contrast =
      0.5f * (tone.At(model.levels[3]).grey - tone.At(model.levels[0]).grey);
  for (int patch = 0; patch < FaceSums::kPatches; ++patch) {
    for (int at = pixels.begin[patch]; at < pixels.begin[patch + 1]; at += kLanes) {
      AddVector(pixels, at, model, pattern, tone, rule, half_contrast, block, totals, sums);
      if (block.filled < kVectors) continue;
      Multiply(block, products);
      block.filled = 0;
      if (++products.blocks == kBlocksInSinglePrecision) Empty(products, rows);
    }
    for (int k = 0; k < kRow; ++k) {
      rows.scores(k, patch) = lanes::Sum(totals.score[k]);
      totals.score[k] = F{};
    }
    for (int k = 0; k < 6; ++k) {
      rows.moments[k] += lanes::Sum(totals.moments[k]);
      totals.moments[k] = F{};
    }
    rows.squares += lanes::Sum(totals.squares);
    rows.curvature += lanes::Sum(totals.curvature);
    totals.squares = totals.curvature = F{};
  }
  Multiply(block, products);
  Empty(products, rows);
  for (int i = 0; i < kRow; ++i) {
    for (int j = 0; j < i; ++j) rows.A(j, i) = rows.A(i, j);
  }
  int brighter = 0, darker = 0;
  for (int k = 0; k < kLanes; ++k) brighter += totals.brighter[k], darker += totals.darker[k];
  sums.CountContradictions(brighter, darker);
}

struct Adding {
  const FacePixels& pixels;
  const FaceModel& model;
  const BlurredPattern& pattern;
  const ToneCurve& tone;
  const RobustRule& rule;
  FaceSums::Rows& rows;
  FaceSums& sums;
  FLEXTIP_LANES_INLINE void Run() { AddAll(pixels, model, pattern, tone, rule, rows, sums); }
};

}  // namespace

void FacePixels::Clear() {
  found.clear();
  for (auto* entries : {&mx, &my, &grey, &part}) entries->clear();
  begin.fill(0);
  count = 0;
}

void FacePixels::Sort() {
  count = static_cast<int>(found.size());
  std::array<int, FaceSums::kPatches> next{};
  for (const Found& pixel : found) ++next[pixel.patch];
  for (int i = 0; i < FaceSums::kPatches; ++i) {
    begin[i + 1] = begin[i] + (next[i] + kLanes - 1) / kLanes * kLanes;
    next[i] = begin[i];
  }
  const auto size = static_cast<std::size_t>(begin.back());
  part.assign(size, 0.0f);
  for (auto* entries : {&mx, &my, &grey}) entries->resize(size);
  for (const Found& pixel : found) {
    const int at = next[pixel.patch]++;
    mx[at] = pixel.x, my[at] = pixel.y, grey[at] = pixel.grey, part[at] = 1.0f;
  }
  for (int i = 0; i < FaceSums::kPatches; ++i) {  // what fills up is like the last pixel
    for (int at = next[i]; at < begin[i + 1]; ++at) {
      mx[at] = mx[at - 1], my[at] = my[at - 1], grey[at] = grey[at - 1];
    }
  }
}

void AddFaceRows(const FacePixels& pixels, const FaceModel& model, const BlurredPattern& pattern,
                 const ToneCurve& tone, const RobustRule& rule, FaceSums::Rows& rows,
                 FaceSums& sums) {
  Adding adding{pixels, model, pattern, tone, rule, rows, sums};
  lanes::RunWidest(adding);
}

}  // namespace flextip
