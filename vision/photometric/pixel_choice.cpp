#include "vision/photometric/pixel_choice.h"

#include <algorithm>
#include <cmath>

#include "vision/grey.h"
#include "vision/photometric/edge_samples.h"
#include "vision/photometric/lanes.h"

namespace flextip {
namespace {

using lanes::F, lanes::I, lanes::kLanes;

constexpr int kFlatEvery = 8;  // of flat pixels one of so many is taken
constexpr double kRowMargin_px = 2.0;

class Chooser {
 public:
  Chooser(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
          const Image& image, FacePixels& pixels)
      : r_(region), pattern_(pattern), lens_(lens), image_(image), pixels_(pixels) {
    limits_ = LimitsWithin(region, pattern);
    to_patch_ = static_cast<float>(2.0 / pattern.Cells());
  }

  void Every(int stride) {
    for (int y = r_.y0; y <= r_.y1; y += stride) {
      for (int x = r_.x0 + (y / stride) % stride; x <= r_.x1; x += stride) {
        const LensMap::Ray& ray = lens_.At(x, y);
        const float z = 1 / (r_.to_tag(2, 0) * ray.x + r_.to_tag(2, 1) * ray.y + r_.to_tag(2, 2));
        const float u = (r_.to_tag(0, 0) * ray.x + r_.to_tag(0, 1) * ray.y + r_.to_tag(0, 2)) * z;
        const float v = (r_.to_tag(1, 0) * ray.x + r_.to_tag(1, 1) * ray.y + r_.to_tag(1, 2)) * z;
        const bool within = u > limits_[0] && u < limits_[1] && v > limits_[2] && v < limits_[3];
        if (within) Consider(x, y, u, v, true, true);
      }
    }
  }

  // Rows within the tag's outline, in steps of eight pixels.
  FLEXTIP_LANES_INLINE void Run() {
    for (int y = r_.y0; y <= r_.y1; ++y) {
      int x0, x1;
      Span(y, x0, x1);
      for (int x = x0 & ~(kLanes - 1); x <= x1; x += kLanes) AddEight(x, y, x0, x1);
    }
  }

 private:
  // The pixels of a row that lie in the outline or near it.
  void Span(int y, int& x0, int& x1) const {
    double low = r_.x1 + 1.0, high = r_.x0 - 1.0;
    const auto& p = r_.places_px;
    const Eigen::Vector2d* outline[] = {&p[0][0], &p[0][2], &p[2][2], &p[2][0], &p[0][0]};
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d &a = *outline[i], &b = *outline[i + 1];
      const double top = std::max(std::min(a.y(), b.y()), y - kRowMargin_px);
      const double bottom = std::min(std::max(a.y(), b.y()), y + kRowMargin_px);
      if (top > bottom) continue;
      const double rate = std::abs(b.y() - a.y()) > 1e-9 ? (b.x() - a.x()) / (b.y() - a.y()) : 0;
      const bool level = rate == 0;
      for (const double x : {level ? a.x() : a.x() + (top - a.y()) * rate,
                             level ? b.x() : a.x() + (bottom - a.y()) * rate}) {
        low = std::min(low, x);
        high = std::max(high, x);
      }
    }
    x0 = std::max(r_.x0, static_cast<int>(std::floor(low - kRowMargin_px)));
    x1 = std::min(r_.x1, static_cast<int>(std::ceil(high + kRowMargin_px)));
  }

  FLEXTIP_LANES_INLINE void AddEight(int x, int y, int x0, int x1) {
    const int first = std::min(x, lens_.WidthPx() - kLanes);  // all eight in the picture
    F mx, my;
    lanes::LoadPairs(&lens_.At(first, y).x, mx, my);
    const Eigen::Matrix3f& T = r_.to_tag;
    const F z = 1.0f / (T(2, 0) * mx + T(2, 1) * my + T(2, 2));
    const F u = (T(0, 0) * mx + T(0, 1) * my + T(0, 2)) * z;
    const F v = (T(1, 0) * mx + T(1, 1) * my + T(1, 2)) * z;
    I iu, iv;
    lanes::ToInt(u + 16.5f, iu);
    lanes::ToInt(v + 16.5f, iv);
    F line_u, line_v;
    lanes::ToFloat(iu - 16, line_u);
    lanes::ToFloat(iv - 16, line_v);
    const F du = u - line_u, dv = v - line_v;
    // A line within reach; from half a cell on always.
    const I near = (du * du < r_.edge_u * r_.edge_u) | (dv * dv < r_.edge_v * r_.edge_v);
    const I at = I{0, 1, 2, 3, 4, 5, 6, 7} + first;
    const I within = (u > limits_[0]) & (u < limits_[1]) & (v > limits_[2]) & (v < limits_[3]) &
                     (at >= std::max(x, x0)) & (at <= x1);
    const I taken = within & (near | (((at + 3 * y) & (kFlatEvery - 1)) == 0));
    if (!lanes::Any(taken)) return;
    float us[kLanes], vs[kLanes];
    std::int32_t is_taken[kLanes], is_near[kLanes];
    lanes::Store(u, us);
    lanes::Store(v, vs);
    std::memcpy(is_taken, &taken, sizeof taken);
    std::memcpy(is_near, &near, sizeof near);
    for (int k = 0; k < kLanes; ++k) {
      if (is_taken[k] != 0) Consider(first + k, y, us[k], vs[k], is_near[k] != 0, false);
    }
  }

  // Of flat pixels takes every eighth: in the order of the picture, or those of a lattice.
  void Consider(int x, int y, float u, float v, bool near_line, bool in_order) {
    if (!pattern_.AllKnown() && !pattern_.Known(u, v, r_.unknown_u, r_.unknown_v)) return;
    const bool edge = near_line && pattern_.NearEdge(u, v, r_.edge_u, r_.edge_v);
    const int place = in_order ? flat_ : x + 3 * y;
    if (!edge) ++flat_;
    if (!edge && place % kFlatEvery != 0) return;
    const LensMap::Ray& ray = lens_.At(x, y);
    pixels_.Add(ray.x, ray.y, GreyAt(image_, x, y),
                FaceSums::PatchOf(u * to_patch_ - 1, v * to_patch_ - 1));
  }

  const TagRegion& r_;
  const BlurredPattern& pattern_;
  const LensMap& lens_;
  const Image& image_;
  FacePixels& pixels_;
  Eigen::Vector4f limits_;
  float to_patch_;
  int flat_ = 0;
};

}  // namespace

Eigen::Vector4f LimitsWithin(const TagRegion& r, const BlurredPattern& pattern) {
  if (!pattern.AllKnown()) return r.limits;
  const auto end = static_cast<float>(pattern.Cells());
  return {std::max(r.limits[0], r.unknown_u), std::min(r.limits[1], end - r.unknown_u),
          std::max(r.limits[2], r.unknown_v), std::min(r.limits[3], end - r.unknown_v)};
}

void ChoosePixels(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
                  const Image& image, FacePixels& pixels) {
  Chooser chooser(region, pattern, lens, image, pixels);
  if (region.samples > 0) {
    SampleEdges(region, pattern, lens, image, pixels);
  } else if (region.stride > 1 || lens.WidthPx() < kLanes) {
    chooser.Every(region.stride);
  } else {
    lanes::RunWidest(chooser);
  }
  pixels.Sort();
}

}  // namespace flextip
