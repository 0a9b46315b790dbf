#include "simulation/render/raster.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace flextip::simulation::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSamples = 233, kLatticeStep = 144;  // neighbours in Fibonacci's sequence
constexpr int kShadedOnceIn = 16;                  // samples of an object in a pixel

// The lattice of a pixel, shifted by numbers that depend on the pixel alone.
class Lattice {
 public:
  Lattice(int x, int y) {
    std::uint32_t h =
        static_cast<std::uint32_t>(x) * 0x8da6b343u ^ static_cast<std::uint32_t>(y) * 0xd8163841u;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    h ^= h >> 16;
    shift_ = {(h & 0xffff) / 65536.0, (h >> 16) / 65536.0};
  }
  Vector2d Point(int k) const {
    const double u = shift_.x() + k / static_cast<double>(kSamples);
    const double v = shift_.y() + (k * kLatticeStep % kSamples) / static_cast<double>(kSamples);
    return {u < 1 ? u : u - 1, v < 1 ? v : v - 1};
  }

 private:
  Vector2d shift_;
};

// What the samples of a pixel found of one object.
struct Part {
  int samples = 0, white = 0, shaded = 0;
  Shade sum;
  Vector3f Colour(const Material& m) const {
    const auto n = static_cast<float>(shaded);
    const float whiteness = static_cast<float>(white) / static_cast<float>(samples);
    const Vector3f albedo = m.albedo_black + whiteness * (m.albedo - m.albedo_black);
    return albedo * (sum.diffuse / n) + Vector3f::Constant(sum.specular / n);
  }
};

}  // namespace

Raster::Raster(const PixelRays& rays, const Scene& scene, const Light& light)
    : rays_(rays), scene_(scene), light_(light) {}

void Raster::Draw(LinearImage& image) const {
  const int across = rays_.WidthPx() + 1, down = rays_.HeightPx() + 1;
  std::vector<std::uint8_t> objects(static_cast<std::size_t>(across) * down, 0);
  tbb::parallel_for(0, down, [&](int j) { ClassifyRow(j, objects); });
  tbb::parallel_for(0, rays_.HeightPx(), [&](int y) { DrawRow(y, objects, image); });
}

void Raster::ClassifyRow(int j, std::vector<std::uint8_t>& objects) const {
  const int width = rays_.WidthPx(), row = std::min(j, rays_.HeightPx() - 1) / Scene::kTile_px;
  Scene::Guesses guesses = scene_.NewGuesses();
  Meeting meeting;
  for (int tile_x = 0; tile_x < scene_.TilesAcross(); ++tile_x) {
    const int tile = row * scene_.TilesAcross() + tile_x;
    if (scene_.InTile(tile) == 0) continue;
    scene_.SetGuesses(tile, guesses);
    const int first = tile_x * Scene::kTile_px;
    const int last = tile_x + 1 == scene_.TilesAcross() ? width : first + Scene::kTile_px - 1;
    for (int i = first; i <= last; ++i) {
      const Vector3d ray = rays_.Corner(i, j);
      if (ray.z() <= 0) continue;
      objects[static_cast<std::size_t>(j) * (width + 1) + i] =
          static_cast<std::uint8_t>(scene_.Trace(ray, scene_.InTile(tile), guesses, meeting));
    }
  }
}

void Raster::DrawRow(int y, const std::vector<std::uint8_t>& objects, LinearImage& image) const {
  const int width = rays_.WidthPx(), height = rays_.HeightPx();
  const int row = y / Scene::kTile_px * scene_.TilesAcross();
  Scene::Guesses guesses = scene_.NewGuesses();
  const auto at = [&](int i, int j) {  // the object at a corner, those outside taken inward
    i = std::clamp(i, 0, width);
    j = std::clamp(j, 0, height);
    return objects[static_cast<std::size_t>(j) * (width + 1) + i];
  };
  for (int x = 0; x < width; ++x) {
    const int tile = row + x / Scene::kTile_px;
    if (scene_.InTile(tile) == 0) {
      x |= Scene::kTile_px - 1;  // on to the next tile
      continue;
    }
    if (x % Scene::kTile_px == 0) scene_.SetGuesses(tile, guesses);
    ObjectMask around = 0;
    for (int j = y - 1; j <= y + 2; ++j) {
      for (int i = x - 1; i <= x + 2; ++i) around |= Bit(at(i, j));
    }
    if (around == 1 || !rays_.Valid(x, y)) continue;
    const int own = at(x, y);
    const bool corners_agree =
        own == at(x + 1, y) && own == at(x, y + 1) && own == at(x + 1, y + 1);
    const bool whole =
        corners_agree && (around == Bit(own) || LooksWhole(x, y, own, around, guesses));
    if (whole && own == 0) continue;
    float* out = image.At(x, y);
    if (!whole || !DrawWithin(x, y, own, guesses, out)) DrawAcross(x, y, around, guesses, out);
  }
}

bool Raster::LooksWhole(int x, int y, int object, ObjectMask seen, Scene::Guesses& guesses) const {
  const PixelRays::Pixel pixel = rays_.At(x, y);
  const Lattice lattice(x, y);
  Meeting meeting;
  constexpr int kStride = 15;  // every 15th point of the lattice still covers the pixel
  for (int k = 0; k < kSamples; k += kStride) {
    const Vector2d p = lattice.Point(k);
    if (scene_.Trace(pixel.At(p.x(), p.y()), seen, guesses, meeting) != object) return false;
  }
  return true;
}

bool Raster::DrawWithin(int x, int y, int object, Scene::Guesses& guesses, float* out) const {
  const PixelRays::Pixel pixel = rays_.At(x, y);
  const Vector3d ray = pixel.Centre();
  const Material& material = scene_.MaterialOf(object);
  const Face* face = scene_.FaceOf(object);
  Meeting meeting;
  double white = 1;
  if (scene_.Trace(ray, Bit(object), guesses, meeting) != object) return false;
  if (face && face->pattern) {
    const std::array<Vector3d, 4> corners = {rays_.Corner(x, y), rays_.Corner(x + 1, y),
                                             rays_.Corner(x + 1, y + 1), rays_.Corner(x, y + 1)};
    std::array<Vector2d, 4> quad;
    for (std::size_t i = 0; i < 4; ++i) {
      double depth = 0;
      if (!face->MeetPlane(corners[i], depth, quad[i])) return false;
      quad[i] /= face->cell_m;
    }
    white = WhitePart(*face->pattern, quad.data());
  }
  const Shade shade = light_.On(meeting.depth * ray, meeting.normal, material);
  const Vector3f albedo =
      material.albedo_black + static_cast<float>(white) * (material.albedo - material.albedo_black);
  Eigen::Map<Vector3f> colour(out);
  colour = albedo * shade.diffuse + Vector3f::Constant(shade.specular);
  return true;
}

void Raster::DrawAcross(int x, int y, ObjectMask seen, Scene::Guesses& guesses, float* out) const {
  const PixelRays::Pixel pixel = rays_.At(x, y);
  const Lattice lattice(x, y);
  std::array<Part, kMaxObjects + 1> parts;
  ObjectMask found = 0;
  Meeting meeting;
  for (int k = 0; k < kSamples; ++k) {
    const Vector2d p = lattice.Point(k);
    const Vector3d ray = pixel.At(p.x(), p.y());
    const int object = scene_.Trace(ray, seen, guesses, meeting);
    if (!(found & Bit(object))) {
      found |= Bit(object);
      parts[object] = Part{};
    }
    Part& part = parts[object];
    if (object != 0 && part.samples % kShadedOnceIn == 0) {
      const Shade s = light_.On(meeting.depth * ray, meeting.normal, scene_.MaterialOf(object));
      part.sum.diffuse += s.diffuse;
      part.sum.specular += s.specular;
      ++part.shaded;
    }
    ++part.samples;
    part.white += meeting.white;
  }
  Eigen::Map<Vector3f> tissue(out);
  Vector3f sum = Vector3f::Zero();
  for (ObjectMask rest = found; rest != 0; rest &= rest - 1) {
    const int object = __builtin_ctzll(rest);
    const Part& part = parts[object];
    const float weight = static_cast<float>(part.samples) / kSamples;
    sum += weight * (object == 0 ? Vector3f(tissue) : part.Colour(scene_.MaterialOf(object)));
  }
  tissue = sum;
}

}  // namespace flextip::simulation::render
