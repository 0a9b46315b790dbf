// Finds the collar in a picture where it is some pixels away from its expected place.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/camera_model.h"

namespace flextip {

class CollarSearch {
 public:
  /// Reads the tags' cells. Throws InputError for a tag that does not exist. The camera must
  /// outlive the search.
  CollarSearch(const CameraModel& camera, const TagCollar& collar);

  struct Match {
    Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
    double correlation = 0;  ///< of the tags' cells and the picture, mean of the faces; -1 to 1
  };
  /// Moves the tags as seen from `T_CE` over the picture, up to `radius_px` in each direction, in
  /// steps of about half a cell. Returns the shift at which they correlate best with the picture.
  Match Find(const Image& image, const Pose& T_CE, double radius_px) const;

  /// Returns T_CE moved across the line of sight, so that the tags in view are seen `shift_px`
  /// away.
  Pose Shifted(const Pose& T_CE, const Eigen::Vector2d& shift_px) const;

  /// A place on a tag: where it would be seen (px), and its whiteness, smoothed over about a cell.
  struct Place {
    Eigen::Vector2d px;
    float white;
  };

 private:
  struct Face {
    CollarTag tag;
    int border_cells;
    std::vector<Eigen::Vector3d> x_E;
    std::vector<float> white;
  };
  struct Seen {
    std::vector<std::vector<Place>> faces;
    std::size_t places = 0;
    Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};  // their bounding box
    double cell_px = 0;
  };
  Seen Look(const Pose& T_CE) const;

  const CameraModel& camera_;
  std::vector<Face> faces_;
};

}  // namespace flextip
