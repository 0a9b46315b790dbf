#include "vision/tags/planar_pose.h"

#include <opencv2/calib3d.hpp>

namespace flextip {

std::vector<Pose> PlanarPoses(const CameraModel& camera, double size_m,
                              const std::array<Eigen::Vector2d, 4>& corners_px) {
  const double h = 0.5 * size_m;
  const std::vector<cv::Point3d> corners_G = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
  std::vector<cv::Point2d> on_plane;  // z = 1, without distortion
  for (const Eigen::Vector2d& px : corners_px) {
    const auto ray = camera.Unproject(px);
    if (!ray || ray->z() < 1e-3) return {};
    on_plane.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(corners_G, on_plane, cv::Matx33d::eye(), cv::noArray(), rotations,
                        translations, false, cv::SOLVEPNP_IPPE_SQUARE);
  } catch (const cv::Exception&) {
    return {};  // corners in a line
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    cv::Matx33d R;
    cv::Rodrigues(rotations[i], R);
    Pose T_CG;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) T_CG.R(row, column) = R(row, column);
      T_CG.p[row] = translations[i].at<double>(row);
    }
    if (T_CG.R.allFinite() && T_CG.p.allFinite() && T_CG.p.z() > 0) poses.push_back(T_CG);
  }
  return poses;
}

}  // namespace flextip
