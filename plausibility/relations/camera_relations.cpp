#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "core/median.h"
#include "plausibility/relations/relations.h"
#include "plausibility/relations/shaft_curve.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

constexpr double kSight_rad = 0.75, kFarthest_m = 2.0;

/// The tip as far as it is known, else the straight shaft's.
std::optional<Vector3d> TipFor(const Scene& scene, const Instant& now) {
  if (now.tip) return now.tip->p;
  const auto along = DirectionToPort(scene, now);
  if (!along) return {};
  return Vector3d(now.wrist->p + scene.instrument.length_m * *along);
}

/// The camera sees the tip most of the time.
void AddView(const CameraCalibration& camera, RelationList& list) {
  const Scene& scene = list.scene();
  const Pose T_CR = camera.T_RC.Inverse();
  std::size_t seen = 0, all = 0, behind = 0;
  for (const Instant& now : scene.instants) {
    const auto tip = TipFor(scene, now);
    if (!tip) continue;
    ++all;
    const Vector3d x = T_CR * *tip;
    if (x.z() <= 0.0) {
      ++behind;
      continue;
    }
    // Lenses distort, and straight shafts are no bent ones: shares of the picture beyond its edge.
    const double margin = now.tip ? 0.25 : 0.6;
    const double u = (camera.cu_px + camera.fu_px * x.x() / x.z()) / camera.width_px;
    const double v = (camera.cv_px + camera.fv_px * x.y() / x.z()) / camera.height_px;
    if (u > -margin && u < 1.0 + margin && v > -margin && v < 1.0 + margin && x.z() < kFarthest_m)
      ++seen;
  }
  if (all < 4) return;
  std::vector<std::string> about{"cam0", "cam0.T_RC"};
  if (scene.Has("vision0")) {
    about.insert(about.end(), {"vision0", "vision0.frame"});
  } else {
    about.insert(about.end(), {"wrist0", "port", "length"});
  }
  const double count = static_cast<double>(all);
  const double out = 1.0 - static_cast<double>(seen) / count;
  list.Add("cam0.view", about, 2.0 * out,
           fmt::format("the tip is outside cam0's picture at {:.0f} % of the times, behind the "
                       "camera at {:.0f} %",
                       100.0 * out, 100.0 * static_cast<double>(behind) / count));
}

/// Depth is what a camera knows worst: the covariance is longest along the line of sight.
void AddSight(const CameraCalibration& camera, RelationList& list) {
  const Pose T_CR = camera.T_RC.Inverse();
  const auto angles = ValuesOf(list.scene(), [&](const Instant& now) -> std::optional<double> {
    if (!now.tip || !now.tip->sight) return {};
    const double angle = AngleBetween(T_CR.R * *now.tip->sight, T_CR * now.tip->p);
    return std::min(angle, std::numbers::pi - angle);
  });
  if (angles.size() < kFewestInstants) return;
  const double angle = Median(angles);
  list.Add("cam0.sight", {"cam0", "cam0.T_RC", "vision0", "vision0.frame"}, angle / kSight_rad,
           fmt::format("vision0 is least certain along a line {} beside cam0's line of sight",
                       DegreesText(angle)));
}

}  // namespace

void AddCameraRelations(RelationList& list) {
  const auto& camera = list.scene().camera;
  if (!camera) return;
  AddView(*camera, list);
  AddSight(*camera, list);
}

}  // namespace flextip::plausibility
