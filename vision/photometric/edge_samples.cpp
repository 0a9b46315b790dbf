#include "vision/photometric/edge_samples.h"

#include <algorithm>
#include <cmath>

#include "vision/grey.h"
#include "vision/photometric/lanes.h"

namespace flextip {
namespace {

using lanes::F, lanes::I, lanes::kLanes;

constexpr float kAlong = 0.7548776662f, kAcross = 0.5698402910f;  // R2's steps
constexpr int kTriesPerFlat = 2;

FLEXTIP_LANES_INLINE void Fraction(const F& x, F& out) {
  I whole;
  lanes::ToInt(x, whole);
  F w;
  lanes::ToFloat(whole, w);
  out = x - w;
}

class Sampler {
 public:
  Sampler(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
          const Image& image, FacePixels& pixels)
      : r_(region),
        pattern_(pattern),
        lens_(lens),
        image_(image),
        pixels_(pixels),
        limits_(LimitsWithin(region, pattern)),
        width_(region.x1 - region.x0 + 1),
        to_patch_(2.0f / static_cast<float>(pattern.Cells())) {
    pixels_.taken.assign(static_cast<std::size_t>(width_) * (r_.y1 - r_.y0 + 1), 0);
    pixels_.places.clear();
  }

  FLEXTIP_LANES_INLINE void Run() {
    Edges();
    Flats();
    Read();
  }

 private:
  using Edge = BlurredPattern::Edge;

  // By an edge's length in the picture, so that pixels count alike.
  FLEXTIP_LANES_INLINE void Edges() {
    const auto& p = r_.places_px;
    const float along_u = static_cast<float>((p[1][2] - p[1][0]).norm());
    const float along_v = static_cast<float>((p[2][1] - p[0][1]).norm());
    float length = 0;
    for (const auto& edge : pattern_.EdgeList()) {
      if (Begins(edge)) length += edge.along_u ? along_u : along_v;
    }
    if (length <= 0) return;
    const float per_length = static_cast<float>(r_.samples) / length;
    float due = 0.5f;
    int drawn = 0;
    for (const auto& edge : pattern_.EdgeList()) {
      if (!Begins(edge)) continue;
      due += per_length * (edge.along_u ? along_u : along_v);
      const int count = static_cast<int>(due);
      due -= static_cast<float>(count);
      Draw(edge, drawn, count);
      drawn += count;
    }
  }

  // All over the tag, but for what is near an edge.
  FLEXTIP_LANES_INLINE void Flats() {
    const float du = limits_[1] - limits_[0], dv = limits_[3] - limits_[2];
    int left = r_.flat_samples;
    for (int i = 0; left > 0 && i < kTriesPerFlat * r_.flat_samples; i += kLanes) {
      F t, s;
      Sequence(i, t, s);
      left -= Take(limits_[0] + t * du, limits_[2] + s * dv, kLanes, true);
    }
  }

  // The rays and grey values of the places, which were asked of the memory when they were found.
  void Read() {
    for (const FacePixels::Place& place : pixels_.places) {
      const LensMap::Ray& ray = lens_.At(place.x, place.y);
      if (!(ray.x == ray.x)) continue;
      pixels_.Add(ray.x, ray.y, GreyAt(image_, place.x, place.y), place.patch);
    }
  }

  // Whether a part of the edge may lie within the limits.
  bool Begins(const Edge& edge) const {
    const float end_u = edge.u + (edge.along_u ? 1.0f : 0.0f);
    const float end_v = edge.v + (edge.along_u ? 0.0f : 1.0f);
    return end_u > limits_[0] && edge.u < limits_[1] && end_v > limits_[2] && edge.v < limits_[3];
  }

  FLEXTIP_LANES_INLINE static void Sequence(int first, F& t, F& s) {
    F i;
    lanes::ToFloat(I{0, 1, 2, 3, 4, 5, 6, 7} + first, i);
    Fraction(i * kAlong, t);
    Fraction(i * kAcross, s);
  }

  FLEXTIP_LANES_INLINE void Draw(const Edge& edge, int first, int count) {
    for (int k = 0; k < count; k += kLanes) {
      F t, s;
      Sequence(first + k, t, s);
      s = 2.0f * s - 1.0f;
      const F u = edge.u + (edge.along_u ? t : s * r_.edge_u);
      const F v = edge.v + (edge.along_u ? s * r_.edge_v : t);
      Take(u, v, std::min(kLanes, count - k), false);
    }
  }

  // Takes the pixels at eight places of the tag, the first `count` of them. Returns how many were
  // new and are not near an edge where `flat`.
  FLEXTIP_LANES_INLINE int Take(const F& u, const F& v, int count, bool flat) {
    F x, y;
    Project(u, v, x, y);
    I column, row;
    lanes::ToInt(x + 0.5f, column);
    lanes::ToInt(y + 0.5f, row);
    const I at = I{0, 1, 2, 3, 4, 5, 6, 7};
    const I within = (u > limits_[0]) & (u < limits_[1]) & (v > limits_[2]) & (v < limits_[3]) &
                     (column >= r_.x0) & (column <= r_.x1) & (row >= r_.y0) & (row <= r_.y1) &
                     (at < count);
    if (!lanes::Any(within)) return 0;
    float us[kLanes], vs[kLanes];
    lanes::Store(u, us);
    lanes::Store(v, vs);
    int taken = 0;
    for (int k = 0; k < kLanes; ++k) {
      if (within[k] == 0) continue;
      if (flat && pattern_.NearEdge(us[k], vs[k], r_.edge_u, r_.edge_v)) continue;
      if (!pattern_.AllKnown() && !pattern_.Known(us[k], vs[k], r_.unknown_u, r_.unknown_v)) {
        continue;
      }
      auto& mark =
          pixels_.taken[static_cast<std::size_t>(row[k] - r_.y0) * width_ + column[k] - r_.x0];
      if (mark != 0) continue;
      mark = 1;
      ++taken;
      __builtin_prefetch(&lens_.At(column[k], row[k]));
      __builtin_prefetch(image_.Row(row[k]) +
                         static_cast<std::ptrdiff_t>(column[k]) * image_.channels);
      pixels_.places.push_back(
          {column[k], row[k], FaceSums::PatchOf(us[k] * to_patch_ - 1, vs[k] * to_patch_ - 1)});
    }
    return taken;
  }

  // Interpolates by parabolas between the nine places of the tag that are known in the picture.
  FLEXTIP_LANES_INLINE void Project(const F& u, const F& v, F& x, F& y) const {
    const F s = u * to_patch_ - 1.0f, t = v * to_patch_ - 1.0f;
    const F bs[3] = {0.5f * s * (s - 1.0f), 1.0f - s * s, 0.5f * s * (s + 1.0f)};
    const F bt[3] = {0.5f * t * (t - 1.0f), 1.0f - t * t, 0.5f * t * (t + 1.0f)};
    x = y = F{};
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const F weight = bt[j] * bs[i];
        x += weight * static_cast<float>(r_.places_px[j][i].x());
        y += weight * static_cast<float>(r_.places_px[j][i].y());
      }
    }
  }

  const TagRegion& r_;
  const BlurredPattern& pattern_;
  const LensMap& lens_;
  const Image& image_;
  FacePixels& pixels_;
  Eigen::Vector4f limits_;
  int width_;
  float to_patch_;
};

}  // namespace

void SampleEdges(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
                 const Image& image, FacePixels& pixels) {
  if (region.x1 < region.x0 || region.y1 < region.y0) return;
  Sampler sampler(region, pattern, lens, image, pixels);
  lanes::RunWidest(sampler);
}

}  // namespace flextip
