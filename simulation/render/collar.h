// The tag collar's body: the prism whose sides carry the tags.
#pragma once

#include <vector>

#include "core/pose.h"
#include "core/tag_collar.h"
#include "simulation/render/face.h"
#include "simulation/render/tag_pattern.h"

namespace flextip::simulation::render {

/// The collar's surface in the tip frame E. Tags whose normals stand across the shaft and that
/// share a place along it form a prism: its section is the convex hull of the tags' plates (the
/// pattern with its white margin), cut by one another's planes, and of a core around the axis. A
/// tag that lies otherwise is a plate by itself.
class CollarBody {
 public:
  /// Tags with ids in `mirrored` are printed left for right.
  CollarBody(const TagCollar& collar, const std::vector<int>& mirrored);
  /// The faces seen from the camera, in its frame.
  std::vector<Face> FacesSeen(const Pose& T_CE) const;

 private:
  struct Plate {  // a tag with its pattern, in E
    Pose T_EG;
    double half_m = 0, cell_m = 0;
    int id = 0;
    std::size_t pattern = 0;
    Eigen::Vector3d Normal() const { return -T_EG.R.col(2); }
    bool AlongShaft() const;
  };
  void AddLonePlate(const Plate& plate);
  void AddPrism(const std::vector<Plate>& ring);
  void AddSide(const std::vector<Plate>& ring, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
               double x0, double x1);
  void AddFace(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& normal,
               const Plate* plate);

  std::vector<TagPattern> patterns_;
  std::vector<Face> faces_;              // in E
  std::vector<std::size_t> pattern_of_;  // of each face; patterns_.size() where it has none
};

}  // namespace flextip::simulation::render
