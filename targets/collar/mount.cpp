#include "targets/collar/mount.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numbers>

#include "core/error.h"

namespace flextip {
namespace {

constexpr int kBoreFlats = 96;

/// Corners in four rings: outside and bore, at the lower and the upper end.
class Builder {
 public:
  Builder(int faces, int flats_of_face) : faces_(faces), flats_(faces * flats_of_face) {}

  int Outside(int end, int i) const { return end * (faces_ + flats_) + i % faces_; }
  int Bore(int end, int i) const { return end * (faces_ + flats_) + faces_ + i % flats_; }
  void Add(int a, int b, int c) { mesh.triangles.push_back({a, b, c}); }
  void AddQuad(int a, int b, int c, int d) {
    Add(a, b, c);
    Add(a, c, d);
  }
  /// Adds a triangle of an end: as given at the upper, turned over at the lower.
  void AddOfEnd(int end, int a, int b, int c) { end == 1 ? Add(a, b, c) : Add(a, c, b); }

  MountSurface mesh;

 private:
  int faces_, flats_;
};

void AddRing(int count, double radius_m, double first_angle, double x_m, MountSurface& mesh) {
  for (int i = 0; i < count; ++i) {
    const double angle = first_angle + 2.0 * std::numbers::pi * i / count;
    mesh.corners_m.emplace_back(x_m, radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
}

template <class T>
void Append(std::vector<char>& bytes, const T& value) {
  const auto* from = reinterpret_cast<const char*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}

}  // namespace

double MountSurface::Volume_m3() const {
  double six = 0.0;
  for (const auto& [a, b, c] : triangles) {
    six += corners_m[static_cast<std::size_t>(a)].dot(
        corners_m[static_cast<std::size_t>(b)].cross(corners_m[static_cast<std::size_t>(c)]));
  }
  return six / 6.0;
}

MountSurface MountMesh(const CollarDesign& design) {
  const int faces = design.wishes.faces, each = (kBoreFlats + faces - 1) / faces;
  const double half_face = std::numbers::pi / faces, half_flat = half_face / each;
  const double corner_m = 0.5 * design.across_m / std::cos(half_face);
  const double bore_m = 0.5 * design.bore_m / std::cos(half_flat);  // flats touch the circle
  Builder b(faces, each);
  for (const double x_m : {-0.5 * design.length_m, 0.5 * design.length_m}) {
    AddRing(faces, corner_m, -half_face, x_m, b.mesh);
    AddRing(faces * each, bore_m, -half_face, x_m, b.mesh);
  }
  for (int i = 0; i < faces; ++i) {
    b.AddQuad(b.Outside(0, i), b.Outside(0, i + 1), b.Outside(1, i + 1), b.Outside(1, i));
    for (int k = i * each; k < (i + 1) * each; ++k) {
      b.AddQuad(b.Bore(0, k), b.Bore(1, k), b.Bore(1, k + 1), b.Bore(0, k + 1));
    }
    const int middle = i * each + each / 2;
    for (const int end : {0, 1}) {
      b.AddOfEnd(end, b.Outside(end, i), b.Outside(end, i + 1), b.Bore(end, middle));
      for (int k = i * each; k < (i + 1) * each; ++k) {
        const int from = k < middle ? i : i + 1;
        b.AddOfEnd(end, b.Outside(end, from), b.Bore(end, k + 1), b.Bore(end, k));
      }
    }
  }
  return b.mesh;
}

void WriteStl(const std::filesystem::path& file, const MountSurface& mesh) {
  static_assert(sizeof(float) == 4);
  std::vector<char> bytes(80, ' ');
  const std::string head = "flextip collar mount, mm";
  std::memcpy(bytes.data(), head.data(), head.size());
  Append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  const auto append = [&](const Eigen::Vector3f& v) {
    for (int i = 0; i < 3; ++i) Append(bytes, v[i]);
  };
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = 1e3 * mesh.corners_m[static_cast<std::size_t>(triangle[i])];
    }
    append((p[1] - p[0]).cross(p[2] - p[0]).normalized().cast<float>());
    for (const auto& corner : p) append(corner.cast<float>());
    Append(bytes, std::uint16_t{0});
  }
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw WorkError(file.string() + ": cannot be written");
}

}  // namespace flextip
