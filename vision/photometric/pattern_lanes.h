// The blurred pattern and its derivatives at eight places: BlurredPattern::At.
#pragma once

#include "vision/photometric/blurred_pattern.h"
#include "vision/photometric/lanes.h"

namespace flextip::lanes {

/// PatternValue at eight places.
struct Pattern {
  F c, c_u, c_v, c_uu, c_uv, c_vv;
};

/// A line between cells at eight places, along one axis.
struct Line {
  I at;
  F x, inverse;      ///< its distance in sigmas; 1 / sigma there
  F below, density;  ///< the normal distribution below the line, and its density there
};

/// An axis of the blur.
struct BlurAxis {
  float sigma, inverse, rate, middle;
  float Reach() const { return NormalTable::kReach * sigma; }
};

/// Fills in a line from its number.
FLEXTIP_LANES_INLINE void SetLine(const F& place, const F& nearness, const BlurAxis& axis,
                                  Line& line) {
  F number;
  ToFloat(line.at, number);
  line.inverse = axis.inverse * nearness * (1.0f + axis.rate * (number - axis.middle));
  line.x = (number - place) * line.inverse;
  CutNormal(line.x, line.below, line.density);
}

/// Adds the crossing of two lines whose axes are correlated: BlurredPattern::AddCrossing.
FLEXTIP_LANES_INLINE void AddCrossing(const F& corner, const Line& u, const Line& v,
                                      const PatternBlur& blur, Pattern& value) {
  const float rho = blur.rho, iu = blur.inverse_u, iv = blur.inverse_v;
  const F x = u.x, y = v.x, density = corner * u.density * v.density;
  const F x2 = x * x - 1.0f, y2 = y * y - 1.0f, tilt = density * rho;
  value.c += tilt * (1.0f + 0.5f * rho * (x * y + (rho / 3) * x2 * y2));
  value.c_u += tilt * x * iu;
  value.c_v += tilt * y * iv;
  value.c_uu += tilt * x2 * (iu * iu);
  value.c_vv += tilt * y2 * (iv * iv);
  value.c_uv += density * (1.0f + rho * x * y) * (iu * iv);
}

/// The four cells at a crossing: before and after the lines, by u, then by v.
struct Cells {
  F c00, c01, c10, c11;
};

FLEXTIP_LANES_INLINE void CellsAt(const I& u, const I& v, const BlurredPattern& pattern,
                                  Cells& cells) {
  I code;
  for (int k = 0; k < kLanes; ++k) code[k] = pattern.CornerCode(u[k], v[k]);
  ToFloat(code & 1, cells.c00);
  ToFloat((code >> 1) & 1, cells.c01);
  ToFloat((code >> 2) & 1, cells.c10);
  ToFloat((code >> 3) & 1, cells.c11);
}

/// Where the nearest line of each axis is the only one within reach.
FLEXTIP_LANES_INLINE void AtOneCrossing(const Line& u, const Line& v, const PatternBlur& blur,
                                        const BlurredPattern& pattern, Pattern& value) {
  Cells cells;
  CellsAt(u.at, v.at, pattern, cells);
  const F rise0 = cells.c10 - cells.c00, rise1 = cells.c11 - cells.c01, corner = rise1 - rise0;
  const F rise = rise1 - v.below * corner;
  value.c = cells.c01 + v.below * (cells.c00 - cells.c01) + (1.0f - u.below) * rise;
  value.c_u = u.density * rise * u.inverse;
  value.c_uu = u.x * value.c_u * u.inverse;
  value.c_v = v.density * v.inverse * (cells.c01 - cells.c00 + (1.0f - u.below) * corner);
  value.c_vv = v.x * value.c_v * v.inverse;
  value.c_uv = F{};
  AddCrossing(corner, u, v, blur, value);
}

/// Where no more than the lines before and after a place are within reach: `u[0]`, `u[1]`.
FLEXTIP_LANES_INLINE void AtFourCrossings(const Line (&u)[2], const Line (&v)[2],
                                          const PatternBlur& blur, const BlurredPattern& pattern,
                                          Pattern& value) {
  F cell[3][3];  // by u, then by v
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      Cells cells;
      CellsAt(u[i].at, v[j].at, pattern, cells);
      cell[i][j] = cells.c00, cell[i][j + 1] = cells.c01;
      cell[i + 1][j] = cells.c10, cell[i + 1][j + 1] = cells.c11;
    }
  }
  const F weight_u[3] = {u[0].below, u[1].below - u[0].below, 1.0f - u[1].below};
  const F weight_v[3] = {v[0].below, v[1].below - v[0].below, 1.0f - v[1].below};
  F column[3], row[3];  // means over v, and over u
  for (int i = 0; i < 3; ++i) {
    column[i] = weight_v[0] * cell[i][0] + weight_v[1] * cell[i][1] + weight_v[2] * cell[i][2];
    row[i] = weight_u[0] * cell[0][i] + weight_u[1] * cell[1][i] + weight_u[2] * cell[2][i];
  }
  value.c = weight_u[0] * column[0] + weight_u[1] * column[1] + weight_u[2] * column[2];
  value.c_u = value.c_v = value.c_uu = value.c_uv = value.c_vv = F{};
  for (int i = 0; i < 2; ++i) {
    const F by_u = u[i].density * u[i].inverse * (column[i + 1] - column[i]);
    const F by_v = v[i].density * v[i].inverse * (row[i + 1] - row[i]);
    value.c_u += by_u;
    value.c_v += by_v;
    value.c_uu += u[i].x * u[i].inverse * by_u;
    value.c_vv += v[i].x * v[i].inverse * by_v;
    for (int j = 0; j < 2; ++j) {
      const F corner = cell[i][j] - cell[i][j + 1] - cell[i + 1][j] + cell[i + 1][j + 1];
      AddCrossing(corner, u[i], v[j], blur, value);
    }
  }
}

/// Keeps a place within four cells of the pattern, beyond which it is as there.
FLEXTIP_LANES_INLINE void Clamp(const F& place, int cells, F& out) {
  constexpr float kBeyond = 4;
  const float last = static_cast<float>(cells) + kBeyond;
  Select(place > -kBeyond, place, F{} - kBeyond, out);
  Select(out < last, out, F{} + last, out);
}

/// Returns the pattern at (u, v), in cells; `nearness` as in PatternBlur.
FLEXTIP_LANES_INLINE void LookUp(const F& u, const F& v, const F& nearness, const PatternBlur& blur,
                                 const BlurredPattern& pattern, Pattern& value) {
  const BlurAxis axis_u{blur.sigma_u, blur.inverse_u, blur.rate_u, blur.middle};
  const BlurAxis axis_v{blur.sigma_v, blur.inverse_v, blur.rate_v, blur.middle};
  F cut_u, cut_v, near_u, near_v;
  Clamp(u, pattern.Cells(), cut_u);
  Clamp(v, pattern.Cells(), cut_v);
  Line nearest_u, nearest_v;
  ToInt(cut_u + 16.5f, nearest_u.at);
  ToInt(cut_v + 16.5f, nearest_v.at);
  nearest_u.at -= 16;
  nearest_v.at -= 16;
  ToFloat(nearest_u.at, near_u);
  ToFloat(nearest_v.at, near_v);
  // The second nearest line is within reach, too.
  F away_u, away_v;
  Select(near_u < cut_u, cut_u - near_u, near_u - cut_u, away_u);
  Select(near_v < cut_v, cut_v - near_v, near_v - cut_v, away_v);
  const I many = (1.0f - away_u < axis_u.Reach()) | (1.0f - away_v < axis_v.Reach());
  if (Any(many) && axis_u.Reach() < 1 && axis_v.Reach() < 1) {
    Line lines_u[2], lines_v[2];
    ToInt(cut_u + 16.0f, lines_u[0].at);
    ToInt(cut_v + 16.0f, lines_v[0].at);
    lines_u[0].at -= 16;
    lines_v[0].at -= 16;
    lines_u[1].at = lines_u[0].at + 1;
    lines_v[1].at = lines_v[0].at + 1;
    for (int i = 0; i < 2; ++i) {
      SetLine(u, nearness, axis_u, lines_u[i]);
      SetLine(v, nearness, axis_v, lines_v[i]);
    }
    AtFourCrossings(lines_u, lines_v, blur, pattern, value);
    return;
  }
  SetLine(u, nearness, axis_u, nearest_u);
  SetLine(v, nearness, axis_v, nearest_v);
  AtOneCrossing(nearest_u, nearest_v, blur, pattern, value);
  for (int k = 0; k < kLanes; ++k) {
    if (many[k] == 0) continue;
    const PatternValue p = pattern.At(u[k], v[k], blur, nearness[k]);
    value.c[k] = p.c, value.c_u[k] = p.c_u, value.c_v[k] = p.c_v;
    value.c_uu[k] = p.c_uu, value.c_uv[k] = p.c_uv, value.c_vv[k] = p.c_vv;
  }
}

}  // namespace flextip::lanes
