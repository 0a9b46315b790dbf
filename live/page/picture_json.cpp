#include "live/page/picture_json.h"

#include <nlohmann/json.hpp>

#include "core/linear_algebra.h"

namespace flextip::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAxis_m = 0.01;           // of the tip's frame as drawn
constexpr double kChi2Of95Percent = 5.99;  // two degrees of freedom

/// Places far outside the picture are of no use, and lenses bend them back in.
std::optional<Eigen::Vector2d> Seen(const CameraModel& camera, const Eigen::Vector3d& p_R) {
  const CameraCalibration& c = camera.Calibration();
  const auto px = camera.Project(c.T_RC.Inverse() * p_R);
  if (!px || px->x() < -c.width_px || px->x() > 2 * c.width_px || px->y() < -c.height_px ||
      px->y() > 2 * c.height_px) {
    return {};
  }
  return px;
}

Json PixelJson(const std::optional<Eigen::Vector2d>& px) {
  return px ? Json::array({px->x(), px->y()}) : Json();
}

/// The covariance seen through the lens: half axes (px) and the larger one's angle (rad).
Json DoubtJson(const CameraModel& camera, const TipObservation& tip) {
  const Pose T_CR = camera.Calibration().T_RC.Inverse();
  Eigen::Matrix<double, 2, 3> J;
  if (!camera.Project(T_CR * tip.p_RE, &J)) return nullptr;
  const Eigen::Matrix<double, 2, 3> J_R = J * T_CR.R;
  const SymmetricEigen axes(Eigen::Matrix2d(J_R * tip.covariance_m2 * J_R.transpose()));
  const Eigen::Vector2d half = (kChi2Of95Percent * axes.values.cwiseMax(0.0)).cwiseSqrt();
  const Eigen::Vector2d major = axes.vectors.col(1);
  return Json::array({half[1], half[0], std::atan2(major.y(), major.x())});
}

}  // namespace

std::string OverlayText(long n, TimeNs t_ns, const CameraModel& camera, const TipTrack& track,
                        const ShaftMoment& moment) {
  Json tags = Json::array();
  for (const TagDetection& tag : track.tags) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : tag.corners_px) corners.push_back(PixelJson(corner));
    tags.push_back({{"id", tag.id}, {"corners", std::move(corners)}});
  }
  Json json{{"type", "picture"},
            {"n", n},
            {"t_ns", std::to_string(t_ns)},
            {"width", camera.Calibration().width_px},
            {"height", camera.Calibration().height_px},
            {"status", Name(track.tip.status)},
            {"tags", std::move(tags)},
            {"tip", nullptr},
            {"doubt", nullptr},
            {"axes", Json::array()},
            {"shaft", Json::array()},
            {"goal", moment.p_RE_goal ? PixelJson(Seen(camera, *moment.p_RE_goal)) : Json()}};
  if (track.tip.status != TipStatus::kLost) {
    json["tip"] = PixelJson(Seen(camera, track.tip.p_RE));
    json["doubt"] = DoubtJson(camera, track.tip);
  }
  if (track.tip.status == TipStatus::kOk) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d end = kAxis_m * Eigen::Vector3d::Unit(axis);
      json["axes"].push_back(PixelJson(Seen(camera, track.T_RE * end)));
    }
  }
  for (const ShapePoint& point : moment.shape)
    json["shaft"].push_back(PixelJson(Seen(camera, point.p_R)));
  return json.dump();
}

}  // namespace flextip::live
