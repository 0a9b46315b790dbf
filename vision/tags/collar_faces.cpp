#include "vision/tags/collar_faces.h"

#include <cmath>

namespace flextip {

std::vector<PhotometricFace> MakeFaces(const TagCollar& collar) {
  std::vector<PhotometricFace> faces;
  for (const CollarTag& tag : collar.tags) {
    const TagCells cells = ReadTagCells(collar.family, tag.id);
    const double reach = 0.5 * cells.cells * tag.size_m / cells.border_cells;
    std::array<PhotometricFace::Side, 4> sides;
    for (auto& side : sides) side.reach_m = reach;
    for (const CollarTag& other : collar.tags) {
      const Eigen::Vector3d n = other.T_EG.R.col(2);
      const double distance = n.dot(other.T_EG.p - tag.T_EG.p);
      for (int i = 0; i < 4 && &other != &tag; ++i) {
        const Eigen::Vector3d out = (i % 2 == 0 ? -1 : 1) * tag.T_EG.R.col(i / 2);
        const double rate = n.dot(out);
        const double meets = distance / rate;
        if (std::abs(rate) < 0.2 || meets < 0.3 * tag.size_m || meets > sides[i].reach_m) continue;
        sides[i] = {meets, other.T_EG};
      }
    }
    faces.emplace_back(tag, cells, sides);
  }
  return faces;
}

}  // namespace flextip
