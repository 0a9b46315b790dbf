#include "calibration/camera/start.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/camera/bundle.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kFocalsOfWidth[] = {0.45, 0.7, 1.1, 1.7, 2.8, 5.0};
// Robust scale while the lens is still coarse, and once all terms are free.
constexpr double kCoarse_px = 3.0, kFine_px = 1.0;
constexpr double kCoarseTolerance = 1e-4;
// So many of the valleys that the coarse search ends in are followed to the bottom.
constexpr std::size_t kFollowed = 3;
// So many corners are enough to find the valley.
constexpr std::size_t kCornersInSearch = 800;

// The homography that takes (x, y) on the board to `to`; empty where the points do not fix one.
std::optional<Eigen::Matrix3d> Homography(const std::vector<Eigen::Vector3d>& x_B,
                                          const std::vector<Eigen::Vector2d>& to) {
  if (to.size() < 4) return {};
  std::vector<cv::Point2d> from_points, to_points;
  for (std::size_t i = 0; i < to.size(); ++i) {
    from_points.emplace_back(x_B[i].x(), x_B[i].y());
    to_points.emplace_back(to[i].x(), to[i].y());
  }
  const cv::Mat found = cv::findHomography(from_points, to_points);
  if (found.empty()) return {};
  Eigen::Matrix3d H;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) H(r, c) = found.at<double>(r, c);
  }
  if (!H.allFinite() || !(H.norm() > 0)) return {};
  return H;
}

// Where the ray through `px` meets the plane z = 1 for a lens without distortion terms.
std::optional<Eigen::Vector2d> OnPlane(const CameraCalibration& c, const Eigen::Vector2d& px) {
  constexpr double kMost_rad = 1.4;
  const Eigen::Vector2d d((px.x() - c.cu_px) / c.fu_px, (px.y() - c.cv_px) / c.fv_px);
  if (c.distortion != Distortion::kEquidistant) return d;
  const double theta = d.norm();
  if (theta > kMost_rad) return {};
  return theta < 1e-9 ? d : Eigen::Vector2d(d * (std::tan(theta) / theta));
}

std::optional<Pose> PoseFromCorners(const CameraCalibration& camera, const SolvedView& view) {
  std::vector<Eigen::Vector3d> x_B;
  std::vector<Eigen::Vector2d> seen;
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    const auto m = OnPlane(camera, view.px[i]);
    if (!m) continue;
    x_B.push_back(view.x_B[i]);
    seen.push_back(*m);
  }
  const auto H = Homography(x_B, seen);
  if (!H) return {};
  double scale = 2.0 / (H->col(0).norm() + H->col(1).norm());
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : x_B) middle += x / static_cast<double>(x_B.size());
  if (H->row(2).dot(Eigen::Vector3d(middle.x(), middle.y(), 1)) < 0) scale = -scale;
  Eigen::Matrix3d R;
  R << scale * H->col(0), scale * H->col(1),
      scale * scale * Eigen::Vector3d(H->col(0)).cross(Eigen::Vector3d(H->col(1)));
  const Svd svd(R);
  Pose T_CB;
  T_CB.R = svd.U * svd.V.transpose();
  if (T_CB.R.determinant() < 0) return {};
  T_CB.p = scale * H->col(2);
  const bool in_front = std::all_of(x_B.begin(), x_B.end(),
                                    [&](const Eigen::Vector3d& x) { return (T_CB * x).z() > 0; });
  if (!in_front) return {};
  return T_CB;
}

CameraSolution Blank(int width_px, int height_px, double focal_px, bool equidistant) {
  CameraSolution s;
  s.camera.width_px = width_px;
  s.camera.height_px = height_px;
  s.camera.fu_px = s.camera.fv_px = focal_px;
  s.camera.cu_px = 0.5 * (width_px - 1);
  s.camera.cv_px = 0.5 * (height_px - 1);
  s.camera.distortion = equidistant ? Distortion::kEquidistant : Distortion::kOpenCv;
  s.camera.distortion_coefficients.assign(equidistant ? 4 : 5, 0.0);
  return s;
}

// Every so many of a view's corners, such that all views together have about kCornersInSearch.
std::vector<SolvedView> Thinned(const std::vector<SolvedView>& views) {
  std::size_t all = 0;
  for (const SolvedView& view : views) all += view.px.size();
  const std::size_t every = std::max<std::size_t>(1, all / kCornersInSearch);
  std::vector<SolvedView> thin;
  for (const SolvedView& view : views) {
    SolvedView part;
    part.name = view.name;
    part.index = view.index;
    const std::size_t step = std::min(every, std::max<std::size_t>(1, view.px.size() / 12));
    for (std::size_t i = 0; i < view.px.size(); i += step) {
      part.ids.push_back(view.ids[i]);
      part.x_B.push_back(view.x_B[i]);
      part.px.push_back(view.px[i]);
      part.reason.emplace_back();
    }
    thin.push_back(part);
  }
  return thin;
}

// The root of the median squared distance: what most corners say, whatever a few do.
double MedianPx(const CameraSolution& s) {
  std::vector<double> d;
  for (const SolvedView& view : s.views) {
    for (const Eigen::Vector2d& r : view.residual_px) d.push_back(r.norm());
  }
  return Median(d);
}

std::vector<int> Range(int from, int to) {
  std::vector<int> v;
  for (int i = from; i < to; ++i) v.push_back(i);
  return v;
}

// Two radial terms first, the principal point held.
bool AdjustCoarsely(CameraSolution& s) {
  std::vector<int> fixed = Range(6, s.IntrinsicsCount());
  fixed.insert(fixed.end(), {2, 3});
  return AdjustBundle(s, {.fixed = fixed,
                          .cauchy_px = kCoarse_px,
                          .max_iterations = 30,
                          .tolerance = kCoarseTolerance});
}

// Then the principal point too, then all terms.
bool AdjustFinely(CameraSolution& s) {
  TryMirroredPoses(s, kCoarse_px);
  const bool good = AdjustBundle(s, {.fixed = Range(6, s.IntrinsicsCount()),
                                     .cauchy_px = kCoarse_px,
                                     .max_iterations = 30,
                                     .tolerance = kCoarseTolerance});
  return good && AdjustBundle(s, {.cauchy_px = kFine_px, .tolerance = kCoarseTolerance});
}

// Views whose corners no pose explains are left out.
CameraSolution WithPoses(CameraSolution blank, const std::vector<SolvedView>& views) {
  blank.views.clear();
  for (SolvedView view : views) {
    const auto T_CB = PoseFromCorners(blank.camera, view);
    if (!T_CB) continue;
    view.T_CB = *T_CB;
    blank.views.push_back(view);
  }
  return blank;
}

SolvedView Mirrored(SolvedView view) {
  Eigen::Vector3d middle_B = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : view.x_B) middle_B += x / static_cast<double>(view.x_B.size());
  const Eigen::Vector3d middle_C = view.T_CB * middle_B, sight = middle_C.normalized();
  const Eigen::Vector3d normal = view.T_CB.R.col(2);
  const Eigen::Vector3d mirrored = 2.0 * normal.dot(sight) * sight - normal;
  view.T_CB.R = RotationWithoutTwist(normal, mirrored) * view.T_CB.R;
  view.T_CB.p = middle_C - view.T_CB.R * middle_B;
  return view;
}

// The solution of thinned views with all corners.
std::optional<CameraSolution> Extended(const CameraSolution& thin,
                                       const std::vector<SolvedView>& views) {
  CameraSolution whole = WithPoses(thin, views);
  for (SolvedView& view : whole.views) {
    for (const SolvedView& of_thin : thin.views) {
      if (of_thin.index == view.index) view.T_CB = of_thin.T_CB;
    }
  }
  if (!AdjustBundle(whole, {.cauchy_px = kFine_px, .tolerance = kCoarseTolerance})) return {};
  TryMirroredPoses(whole, kFine_px);
  return whole;
}

}  // namespace

std::optional<double> FocalOfVanishingPoints(const std::vector<SolvedView>& views,
                                             const Eigen::Vector2d& centre_px) {
  constexpr double kLeastTilt = 1e-3;  // of a, in 1 / focal^2 of the picture's own size
  double numerator = 0.0, denominator = 0.0;
  const double size2 = centre_px.squaredNorm();
  for (const SolvedView& view : views) {
    std::vector<Eigen::Vector2d> centred;
    for (const Eigen::Vector2d& px : view.px) {
      centred.emplace_back((px - centre_px) / std::sqrt(size2));
    }
    const auto H = Homography(view.x_B, centred);
    if (!H) continue;
    const Eigen::Vector3d a = H->col(0) / H->col(0).norm(), b = H->col(1) / H->col(0).norm();
    // w (a_x b_x + a_y b_y) + a_z b_z = 0 and the like with a^2 - b^2, w = 1 / focal^2.
    const double c1 = a.head<2>().dot(b.head<2>()), d1 = a.z() * b.z();
    const double c2 = a.head<2>().squaredNorm() - b.head<2>().squaredNorm(),
                 d2 = a.z() * a.z() - b.z() * b.z();
    numerator -= c1 * d1 + 0.25 * c2 * d2;
    denominator += c1 * c1 + 0.25 * c2 * c2;
  }
  if (!(denominator > 0) || !(numerator / denominator > kLeastTilt)) return {};
  return std::sqrt(size2 * denominator / numerator);
}

void TryMirroredPoses(CameraSolution& solution, double cauchy_px) {
  const auto fitted = [&](const SolvedView& view, double& median_px) {
    CameraSolution alone;
    alone.camera = solution.camera;
    alone.warp = solution.warp;
    alone.views = {view};
    const bool good = AdjustBundle(
        alone, {.fix_intrinsics = true, .cauchy_px = cauchy_px, .tolerance = kCoarseTolerance});
    median_px = good ? MedianPx(alone) : HUGE_VAL;
    return alone.views[0];
  };
  for (SolvedView& view : solution.views) {
    double here_px = HUGE_VAL, there_px = HUGE_VAL;
    fitted(view, here_px);
    const SolvedView there = fitted(Mirrored(view), there_px);
    if (there_px < here_px) view = there;
  }
}

std::optional<CameraSolution> StartSolution(const std::vector<SolvedView>& views, int width_px,
                                            int height_px, bool equidistant) {
  const std::vector<SolvedView> thin = Thinned(views);
  const Eigen::Vector2d centre_px(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  std::vector<double> focals_px;
  if (const auto focal = FocalOfVanishingPoints(thin, centre_px)) focals_px.push_back(*focal);
  for (const double f : kFocalsOfWidth) focals_px.push_back(f * width_px);
  std::vector<CameraSolution> valleys;
  for (const double focal_px : focals_px) {
    CameraSolution s = WithPoses(Blank(width_px, height_px, focal_px, equidistant), thin);
    if (2 * s.views.size() >= views.size() && AdjustCoarsely(s)) valleys.push_back(std::move(s));
  }
  const auto better = [](const CameraSolution& a, const CameraSolution& b) {
    return MedianPx(a) < MedianPx(b);
  };
  std::sort(valleys.begin(), valleys.end(), better);
  std::optional<CameraSolution> best;
  for (std::size_t i = 0; i < valleys.size() && i < kFollowed; ++i) {
    if (AdjustFinely(valleys[i]) && (!best || better(valleys[i], *best))) best = valleys[i];
  }
  if (!best) return {};
  return Extended(*best, views);
}

}  // namespace flextip
