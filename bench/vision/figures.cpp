#include "bench/vision/figures.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/rotation.h"
#include "vision/tags/collar_pose.h"

namespace flextip::bench {
namespace {

// Squared distances of four corners, summed; the least of four orders where any will do.
double Apart2(const TagCorners& a, const TagCorners& b, bool any_order) {
  double least = 1e300;
  for (const int direction : {1, 3}) {
    for (std::size_t shift = 0; shift < 4; ++shift) {
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        sum += (a[k] - b[(shift + direction * k) % 4]).squaredNorm();
      }
      least = std::min(least, sum);
      if (!any_order) return least;
    }
  }
  return least;
}

}  // namespace

void PeerScore::Add(const PeerAnswer& answer, const PictureTruth& truth, bool any_order) {
  ++figures_.pictures;
  figures_.tags += static_cast<int>(truth.corners_px.size());
  ms_.push_back(answer.ms);
  TagsFound left = truth.corners_px;
  for (const auto& [id, corners] : answer.corners_px) {
    auto best = left.end();
    double least = 4 * kSameTag_px * kSameTag_px;
    for (auto it = left.lower_bound(id); it != left.upper_bound(id); ++it) {
      const double apart = Apart2(corners, it->second, any_order);
      if (apart < least) {
        least = apart;
        best = it;
      }
    }
    if (best == left.end()) {
      ++figures_.false_tags;
      continue;
    }
    left.erase(best);
    ++figures_.tags_found;
    corner_sum_px2_ += least;
    corners_ += 4;
  }
  if (answer.T_CE && truth.T_CE) AddPose(*answer.T_CE, truth);
}

void PeerScore::AddPose(const Pose& T_CE, const PictureTruth& truth) {
  ++figures_.poses;
  const Eigen::Vector3d e = T_CE.p - truth.T_CE->p;
  const double turn = LogRotation(T_CE.R * truth.T_CE->R.transpose()).norm() * 180 / M_PI;
  if (e.norm() > kFalsePose_m || turn > kFalsePose_deg) {
    ++figures_.false_poses;
    return;
  }
  tip_sum_mm2_ += 1e6 * e.squaredNorm();
  tip_mm_.push_back(1e3 * e.norm());
  depth_sum_mm_ += 1e3 * e.z();
  turn_sum_deg2_ += turn * turn;
  figures_.tip_largest_mm = std::max(figures_.tip_largest_mm, 1e3 * e.norm());
  for (const CollarTag& tag : collar_.tags) {
    const auto seen = truth.corners_px.find(tag.id);
    if (seen == truth.corners_px.end()) continue;
    const auto x_E = CornersInE(tag);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto px = camera_.Project(T_CE * x_E[k]);
      if (!px) continue;
      pose_corner_sum_px2_ += (*px - seen->second[k]).squaredNorm();
      ++pose_corners_;
    }
  }
}

PeerFigures PeerScore::Figures(const std::string& name) const {
  PeerFigures f = figures_;
  const auto mean = [](double sum, int count) { return count > 0 ? sum / count : 0.0; };
  const int good = f.GoodPoses();
  f.name = name;
  f.corner_rms_px = std::sqrt(mean(corner_sum_px2_, corners_));
  f.pose_corner_rms_px = std::sqrt(mean(pose_corner_sum_px2_, pose_corners_));
  f.tip_rms_mm = std::sqrt(mean(tip_sum_mm2_, good));
  f.tip_median_mm = Median(tip_mm_);
  f.depth_bias_mm = mean(depth_sum_mm_, good);
  f.turn_rms_deg = std::sqrt(mean(turn_sum_deg2_, good));
  f.ms = Median(ms_);
  return f;
}

}  // namespace flextip::bench
