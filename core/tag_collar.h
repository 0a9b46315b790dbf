// The AprilTags on the instrument: which, how large, and where on the tip frame E.
#pragma once

#include <string>
#include <vector>

#include "core/pose.h"

namespace flextip {

/// One tag. G: origin at its centre, x right and y down as it is read, z into it. `size_m` is the
/// side between the detected corners (tag36h11: the black border's outer edge).
struct CollarTag {
  int id = 0;
  double size_m = 0.0;
  Pose T_EG;
};

struct TagCollar {
  std::string family = "tag36h11";
  std::vector<CollarTag> tags;
};

}  // namespace flextip
