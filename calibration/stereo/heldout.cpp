#include "calibration/stereo/heldout.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "calibration/stereo/bundle.h"
#include "calibration/stereo/rectification.h"

namespace flextip {
namespace {

// Sums over corners that both eyes saw, rectified.
struct Sums {
  double rows_px2 = 0.0, lengths_m2 = 0.0, lengths_m = 0.0;
  int corners = 0, lengths = 0;
};

struct Seen {
  Eigen::Vector3d x_B;                // as the board is
  Eigen::Vector2d left_px, right_px;  // rectified
};

std::map<int, Seen> SeenByBoth(const StereoSolution& s, const StereoView& view,
                               const Rectification& rectification) {
  std::map<int, std::size_t> right;
  for (std::size_t i = 0; i < view.eyes[1].ids.size(); ++i) {
    if (view.eyes[1].IsUsed(i)) right[view.eyes[1].ids[i]] = i;
  }
  std::map<int, Seen> seen;
  for (std::size_t i = 0; i < view.eyes[0].ids.size(); ++i) {
    const auto other = right.find(view.eyes[0].ids[i]);
    if (other == right.end() || !view.eyes[0].IsUsed(i)) continue;
    const auto a = RectifiedPixel(rectification, 0, s.cameras[0], view.eyes[0].px[i]);
    const auto b = RectifiedPixel(rectification, 1, s.cameras[1], view.eyes[1].px[other->second]);
    if (a && b) {
      seen[other->first] = {s.CornerOf(view.eyes[0], i), *a, *b};
    }
  }
  return seen;
}

Eigen::Vector3d Triangulate(const Eigen::Matrix4d& Q, const Seen& s) {
  return (Q * Eigen::Vector4d(s.left_px.x(), 0.5 * (s.left_px.y() + s.right_px.y()),
                              s.left_px.x() - s.right_px.x(), 1.0))
      .hnormalized();
}

// The next id is to the right, not at the other end of the next row.
bool BesideInRow(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return b.x() > a.x() && std::abs(b.y() - a.y()) < 0.3 * (b.x() - a.x());
}

void Add(const StereoSolution& s, const StereoView& view, const Rectification& rectification,
         Sums& sums) {
  const auto seen = SeenByBoth(s, view, rectification);
  const Eigen::Matrix4d Q = rectification.Q();
  const Seen* before = nullptr;
  int id_before = 0;
  for (const auto& [id, corner] : seen) {
    sums.rows_px2 += std::pow(corner.left_px.y() - corner.right_px.y(), 2);
    ++sums.corners;
    if (before && id == id_before + 1 && BesideInRow(before->x_B, corner.x_B)) {
      const double error = (Triangulate(Q, corner) - Triangulate(Q, *before)).norm() -
                           (corner.x_B - before->x_B).norm();
      sums.lengths_m2 += error * error;
      sums.lengths_m += error;
      ++sums.lengths;
    }
    before = &corner;
    id_before = id;
  }
}

}  // namespace

std::optional<StereoHeldOut> LeavePairsOut(const StereoSolution& solution, int folds) {
  Sums sums;
  double squares_px2 = 0.0, count = 0.0;
  std::vector<double> of_pairs_px2;
  for (int fold = 0; fold < folds; ++fold) {
    StereoSolution rest = solution;
    rest.views.clear();
    std::vector<StereoView> left_out;
    int both = 0;
    for (const StereoView& view : solution.views) {
      const bool out = view.InBoth() && both++ % folds == fold;
      (out ? left_out : rest.views).push_back(view);
    }
    if (!AdjustStereo(rest, {.estimate_warp = solution.warp_estimated,
                             .estimate_shape = solution.shape.sd_m > 0})) {
      return {};
    }
    const Rectification rectification = Rectify(rest.cameras, rest.T_C0C1);
    for (const StereoView& view : left_out) {
      StereoSolution alone = rest;
      alone.views = {view};
      if (!AdjustStereo(alone, {.fix_cameras = true})) return {};
      const double squares = std::pow(alone.RmsPx(), 2) * alone.CornersUsed(),
                   free = std::max(1.0, alone.CornersUsed() - 3.0);  // 6 / 2 for the pose
      of_pairs_px2.push_back(squares / free);
      squares_px2 += squares;
      count += free;
      Add(alone, view, rectification, sums);
    }
  }
  if (sums.corners == 0 || sums.lengths == 0) return {};
  return StereoHeldOut{.rms_px = std::sqrt(squares_px2 / count),
                       .epipolar_rms_px = std::sqrt(sums.rows_px2 / sums.corners),
                       .length_rms_m = std::sqrt(sums.lengths_m2 / sums.lengths),
                       .length_mean_m = sums.lengths_m / sums.lengths,
                       .squared_px2 = std::move(of_pairs_px2)};
}

double EpipolarRmsPx(const StereoSolution& solution) {
  const Rectification rectification = Rectify(solution.cameras, solution.T_C0C1);
  Sums sums;
  for (const StereoView& view : solution.views) Add(solution, view, rectification, sums);
  return sums.corners > 0 ? std::sqrt(sums.rows_px2 / sums.corners) : 0.0;
}

}  // namespace flextip
