#include "calibration/uncertainty/next_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
// The board's part of the picture's width when it faces the camera.
constexpr std::array kWidths = {0.25, 0.4, 0.6, 0.85};
constexpr std::array kPlaces = {0.2, 0.5, 0.8};  // of its centre, as a part of the picture
const std::array<Eigen::Vector3d, 5> kTilts = {
    Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.7, 0, 0), Eigen::Vector3d(-0.7, 0, 0),
    Eigen::Vector3d(0, 0.7, 0), Eigen::Vector3d(0, -0.7, 0)};

Eigen::AlignedBox3d BoxOf(const std::vector<Eigen::Vector3d>& x_B) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : x_B) box.extend(x);
  return box;
}

bool AllSeen(const CameraModel& model, const Pose& T_CB, const std::vector<Eigen::Vector3d>& x_B) {
  const CameraCalibration& c = model.Calibration();
  const double margin = 0.01 * c.width_px;
  return std::all_of(x_B.begin(), x_B.end(), [&](const Eigen::Vector3d& x) {
    const auto px = model.Project(T_CB * x);
    return px && px->x() > margin && px->y() > margin && px->x() < c.width_px - 1 - margin &&
           px->y() < c.height_px - 1 - margin;
  });
}

double Figure(const ProjectionUncertainty& uncertainty, const NextViewOptions& options) {
  const UncertaintyMap map = MapUncertainty(uncertainty, options.depth_m);
  return options.worst ? map.LargestPx() : map.MeanPx();
}

}  // namespace

std::vector<Pose> CandidateViews(const CameraSolution& solution,
                                 const std::vector<Eigen::Vector3d>& x_B) {
  const CameraCalibration& c = solution.camera;
  const CameraModel model(c);
  const Eigen::AlignedBox3d box = BoxOf(x_B);
  std::vector<Pose> poses;
  for (const double width : kWidths) {
    const double depth_m = c.fu_px * box.sizes().x() / (width * c.width_px);
    for (const double u : kPlaces) {
      for (const double v : kPlaces) {
        const auto ray = model.Unproject({u * c.width_px, v * c.height_px});
        if (!ray) continue;
        for (const Eigen::Vector3d& tilt : kTilts) {
          Pose T_CB;
          T_CB.R = ExpRotation(tilt);
          T_CB.p = *ray / ray->z() * depth_m - T_CB.R * box.center();
          if (AllSeen(model, T_CB, x_B)) poses.push_back(T_CB);
        }
      }
    }
  }
  return poses;
}

std::vector<NextView> RankNextViews(const ProjectionUncertainty& uncertainty,
                                    const std::vector<Pose>& candidates,
                                    const std::vector<Eigen::Vector3d>& x_B,
                                    const NextViewOptions& options) {
  const double before_px = Figure(uncertainty, options);
  const Eigen::Vector3d centre_B = BoxOf(x_B).center();
  std::vector<NextView> views;
  for (const Pose& T_CB : candidates) {
    const double after_px = Figure(uncertainty.WithView(T_CB, x_B), options);
    views.push_back(
        {T_CB, before_px, after_px, HoldTheBoard(uncertainty.Camera(), centre_B, T_CB)});
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const NextView& a, const NextView& b) { return a.after_px < b.after_px; });
  return views;
}

std::string HoldTheBoard(const CameraCalibration& camera, const Eigen::Vector3d& centre_B,
                         const Pose& T_CB) {
  const Eigen::Vector3d centre = T_CB * centre_B;
  const auto px = CameraModel(camera).Project(centre);
  std::string place = "outside the picture";
  if (px) {
    const auto third = [](double at, double size) { return std::clamp(int(3 * at / size), 0, 2); };
    static const char* const kNames[3][3] = {{"upper left", "top", "upper right"},
                                             {"left", "middle", "right"},
                                             {"lower left", "bottom", "lower right"}};
    place = fmt::format("in the {} of the picture",
                        kNames[third(px->y(), camera.height_px)][third(px->x(), camera.width_px)]);
  }
  // Which side comes nearer is told by the normal, which points away from the camera: where it
  // leans to the right, the board's right edge is the nearer one.
  const Eigen::Vector3d normal = T_CB.R.col(2);
  const double tilt_deg = std::acos(std::clamp(normal.z(), -1.0, 1.0)) / kDeg;
  std::string tilt = "facing the camera";
  if (tilt_deg > 5) {
    const bool sideways = std::abs(normal.x()) > std::abs(normal.y());
    const char* side =
        sideways ? (normal.x() > 0 ? "right" : "left") : (normal.y() > 0 ? "lower" : "upper");
    tilt = fmt::format("tilted by {:.0f} deg, its {} side nearer", tilt_deg, side);
  }
  return fmt::format("hold the board {}, {:.0f} mm away, {}", place, 1e3 * centre.z(), tilt);
}

}  // namespace flextip
