#include "calibration/hand_eye/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/rotation.h"
#include "recording/resample.h"

namespace flextip {
namespace {

constexpr double kSamePose_rad = 0.01;
constexpr int kMaxIterations = 100;
constexpr std::size_t kMinCorners = 4;
// A corner is dropped where it is this many times the median distance off, and a pixel at least;
// not more than a fifth of them.
constexpr double kOutlierOfMedian = 6.0, kOutlier_px = 1.0;
constexpr double kMaxDropped = 0.2;

Pose ToPose(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  Pose T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.R(row, column) = R(row, column);
    T.p[row] = translation.at<double>(row);
  }
  return T;
}

// Infinitesimal plane-based pose estimation (Collins and Bartoli 2014).
std::vector<Pose> PlanarStarts(const CameraModel& camera, const Correspondence* points,
                               std::size_t count) {
  std::vector<cv::Point3d> on_board;
  std::vector<cv::Point2d> on_plane;
  for (std::size_t i = 0; i < count; ++i) {
    const auto ray = camera.Unproject(points[i].px);
    if (!ray || ray->z() < 1e-3) continue;
    on_board.emplace_back(points[i].x_E.x(), points[i].x_E.y(), points[i].x_E.z());
    on_plane.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  std::vector<cv::Mat> rotations, translations;
  if (on_board.size() < kMinCorners) return {};
  try {
    cv::solvePnPGeneric(on_board, on_plane, cv::Matx33d::eye(), cv::noArray(), rotations,
                        translations, false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {};  // corners in a line
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Pose T = ToPose(rotations[i], translations[i]);
    if (T.R.allFinite() && T.p.allFinite() && T.p.z() > 0) poses.push_back(T);
  }
  return poses;
}

bool Flat(const std::vector<Correspondence>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& point : points) mean += point.x_E / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : points) scatter += (p.x_E - mean) * (p.x_E - mean).transpose();
  const Eigen::Vector3d squares = SymmetricEigenvalues(scatter);
  return squares[0] < 1e-8 * squares[2];
}

std::vector<Pose> Starts(const CameraModel& camera, const std::vector<Correspondence>& points) {
  if (Flat(points)) return PlanarStarts(camera, points.data(), points.size());
  std::vector<Pose> starts;  // by the tags of a collar
  for (std::size_t i = 0; i + 4 <= points.size(); i += 4) {
    for (const Pose& T : PlanarStarts(camera, points.data() + i, 4)) starts.push_back(T);
  }
  return starts;
}

// The distinct minima, the best first, two at most.
std::vector<BoardPose> Minima(const CameraModel& camera,
                              const std::vector<Correspondence>& points) {
  std::vector<BoardPose> minima;
  for (const Pose& start : Starts(camera, points)) {
    const auto at = MinimiseReprojection(camera, points, start, kMaxIterations);
    if (!at) continue;
    const bool known = std::any_of(minima.begin(), minima.end(), [&](const BoardPose& other) {
      return PoseDifference(at->T_CE, other.T_CB).head<3>().norm() < kSamePose_rad;
    });
    if (!known) minima.push_back({at->T_CE, at->error.JtJ, at->error.squared_px2});
  }
  std::sort(minima.begin(), minima.end(),
            [](const BoardPose& a, const BoardPose& b) { return a.squared_px2 < b.squared_px2; });
  if (minima.size() > 2) minima.resize(2);
  return minima;
}

// The corners that fit `pose`.
std::vector<Correspondence> Fitting(const CameraModel& camera,
                                    const std::vector<Correspondence>& points, const Pose& T_CB) {
  std::vector<double> distance_px;
  distance_px.reserve(points.size());
  for (const auto& point : points) {
    distance_px.push_back((camera.Project(T_CB * point.x_E).value() - point.px).norm());
  }
  const double limit = std::max(kOutlier_px, kOutlierOfMedian * Median(distance_px));
  std::vector<Correspondence> fitting;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (distance_px[i] <= limit) fitting.push_back(points[i]);
  }
  return fitting;
}

}  // namespace

double SeenBoard::RmsPx() const {
  if (poses.empty() || points.empty()) return 0.0;
  return std::sqrt(poses.front().squared_px2 / static_cast<double>(points.size()));
}

SeenBoard FitSeenBoard(const CameraModel& camera, const BoardSighting& sighting) {
  SeenBoard seen;
  seen.reason = sighting.reason;
  if (!sighting.Found()) return seen;
  for (std::size_t i = 0; i < sighting.px.size(); ++i) {
    seen.points.push_back({sighting.x_B[i], sighting.px[i]});
  }
  seen.reason = fmt::format("{} corners are too few for a pose", seen.points.size());
  if (seen.points.size() < kMinCorners) return seen;
  seen.poses = Minima(camera, seen.points);
  seen.reason = "no pose fits the corners";
  if (seen.poses.empty()) return seen;
  if (Flat(seen.points)) {
    auto fitting = Fitting(camera, seen.points, seen.poses.front().T_CB);
    const std::size_t dropped = seen.points.size() - fitting.size();
    const auto most =
        static_cast<std::size_t>(kMaxDropped * static_cast<double>(seen.points.size()));
    if (dropped > 0 && dropped <= most) {
      seen.points = std::move(fitting);
      seen.dropped = static_cast<int>(dropped);
      seen.poses = Minima(camera, seen.points);
      if (seen.poses.empty()) return seen;
    }
  }
  seen.reason.clear();
  return seen;
}

void RefitSeenBoard(const CameraModel& camera, SeenBoard& seen) {
  for (BoardPose& pose : seen.poses) {
    const auto at = MinimiseReprojection(camera, seen.points, pose.T_CB, kMaxIterations);
    if (at) pose = {at->T_CE, at->error.JtJ, at->error.squared_px2};
  }
}

std::optional<WristAtView> WristAround(const WristStream& stream, TimeNs t_ns) {
  const auto at = WristAt(stream, t_ns);
  if (!at || !at->q_RW) return {};
  WristAtView wrist;
  wrist.T_RW = Pose::FromQuaternion(*at->q_RW, at->p_RW);
  const double u = FindBracket(stream.samples, t_ns)->fraction;
  wrist.noise_share = (1 - u) * (1 - u) + u * u;
  // Two samples away on either side: none that T_RW comes from has a part in it but symmetrically.
  const double h_s = 2.0 / stream.rate_hz;
  const auto h_ns = static_cast<TimeNs>(std::llround(1e9 * h_s));
  const auto before = WristAt(stream, t_ns - h_ns), after = WristAt(stream, t_ns + h_ns);
  if (before && after && before->q_RW && after->q_RW) {
    const Pose from = Pose::FromQuaternion(*before->q_RW, before->p_RW);
    const Pose to = Pose::FromQuaternion(*after->q_RW, after->p_RW);
    wrist.step = PoseDifference(from, to);
    wrist.velocity = wrist.step / (2 * h_s);
    wrist.bend = PoseDifference(MovePose(from, 0.5 * wrist.step), wrist.T_RW);
    wrist.velocity_noise_1_s2 = 2 * wrist.noise_share / (4 * h_s * h_s);
  }
  return wrist;
}

}  // namespace flextip
