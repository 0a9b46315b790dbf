// The mount as read back from its STL file: closed, the right way out, of the right volume.
#include "targets/collar/mount.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>

#include "tests/targets/rasterise.h"

namespace flextip {
namespace {

struct Facet {
  Eigen::Vector3f normal;
  std::array<Eigen::Vector3f, 3> corners;
};

std::vector<Facet> ReadStl(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + 50 * static_cast<std::size_t>(count));
  std::vector<Facet> facets(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = bytes.data() + 84 + 50 * i;
    std::memcpy(facets[i].normal.data(), at, 12);
    for (std::size_t k = 0; k < 3; ++k) {
      std::memcpy(facets[i].corners[k].data(), at + 12 + 12 * k, 12);
    }
  }
  return facets;
}

class Mount : public testing::TestWithParam<int> {};

TEST_P(Mount, IsAClosedPrismWithABore) {
  const CollarDesign d = DesignCollar({.faces = GetParam()});
  const auto file = Scratch("mount.stl");
  WriteStl(file, MountMesh(d));
  std::map<std::array<float, 3>, int> corners;
  std::map<std::pair<int, int>, int> edges;  // by direction
  double six_volumes = 0;
  float most_across = 0;
  const auto facets = ReadStl(file);
  for (const Facet& f : facets) {
    std::array<int, 3> ids;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& c = f.corners[k];
      ids[k] = corners.try_emplace({c.x(), c.y(), c.z()}, static_cast<int>(corners.size()))
                   .first->second;
      most_across = std::max(most_across, c.tail<2>().norm());
    }
    for (std::size_t k = 0; k < 3; ++k) ++edges[{ids[k], ids[(k + 1) % 3]}];
    const Eigen::Vector3f cross = (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]);
    EXPECT_NEAR(f.normal.dot(cross.normalized()), 1.0f, 1e-4f);
    six_volumes += f.corners[0].cast<double>().dot(
        f.corners[1].cast<double>().cross(f.corners[2].cast<double>()));
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  // A body with one hole: V - E + F = 0.
  EXPECT_EQ(static_cast<long>(corners.size()) - static_cast<long>(edges.size()) / 2 +
                static_cast<long>(facets.size()),
            0);
  const double n = d.wishes.faces, across = 1e3 * d.across_m, bore = 1e3 * d.bore_m;
  const double prism = n * 0.25 * across * across * std::tan(std::numbers::pi / n);
  const double hole = 0.25 * std::numbers::pi * bore * bore;
  EXPECT_NEAR(six_volumes / 6, (prism - hole) * 1e3 * d.length_m, 0.002 * hole * 1e3 * d.length_m);
  EXPECT_NEAR(six_volumes / 6, 1e9 * MountMesh(d).Volume_m3(), 0.01);
  EXPECT_NEAR(most_across, 0.5 * across / std::cos(std::numbers::pi / n), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Prisms, Mount, testing::Values(3, 5, 6, 7, 16));

TEST(Mount, FacesStandWhereTheTagsAre) {
  const CollarDesign d = DesignCollar({});
  const MountSurface mesh = MountMesh(d);
  for (const CollarTag& tag : d.collar.tags) {
    const Eigen::Vector3d out = -tag.T_EG.R.col(2);
    int on_face = 0;
    for (const Eigen::Vector3d& corner : mesh.corners_m) {
      const double off = out.dot(corner) - 0.5 * d.across_m;
      EXPECT_LT(off, 1e-9);
      on_face += off > -1e-9 ? 1 : 0;
    }
    EXPECT_EQ(on_face, 4);
  }
}

}  // namespace
}  // namespace flextip
