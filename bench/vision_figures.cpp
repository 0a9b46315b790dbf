#include "bench/vision_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/rotation.h"
#include "vision/collar_pose.h"

namespace flextip {
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

// A dash where there was nothing to measure.
std::string Cell(const char* format, double value, bool measured) {
  return measured ? fmt::format(fmt::runtime(format), value) : "–";
}

}  // namespace

void PeerScore::Add(const PeerAnswer& answer, const PictureTruth& truth, bool any_order) {
  ++figures_.pictures;
  figures_.tags += static_cast<int>(truth.corners_px.size());
  ms_sum_ += answer.ms;
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
  const int good = f.poses - f.false_poses;
  f.name = name;
  f.corner_rms_px = std::sqrt(mean(corner_sum_px2_, corners_));
  f.pose_corner_rms_px = std::sqrt(mean(pose_corner_sum_px2_, pose_corners_));
  f.tip_rms_mm = std::sqrt(mean(tip_sum_mm2_, good));
  std::vector<double> sorted = tip_mm_;
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty()) f.tip_median_mm = sorted[sorted.size() / 2];
  f.depth_bias_mm = mean(depth_sum_mm_, good);
  f.turn_rms_deg = std::sqrt(mean(turn_sum_deg2_, good));
  f.ms = mean(ms_sum_, f.pictures);
  return f;
}

std::string CompareTable(const CompareRow& row, bool with_pose) {
  std::string table =
      with_pose ? "| | corner RMS px | of the pose's corners px | tip RMS mm | "
                  "median mm | largest mm | depth bias mm | turn deg | tags found | poses | "
                  "false poses | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n"
                : "| | corner RMS px | tags found | other tags | ms |\n"
                  "|---|---|---|---|---|\n";
  for (const PeerFigures& f : row.peers) {
    const std::string found = fmt::format("{} of {}", f.tags_found, f.tags);
    const auto corner = [&](double v) { return Cell("{:.3f}", v, f.tags_found > 0); };
    const auto pose = [&](double v) { return Cell("{:.3f}", v, f.poses > f.false_poses); };
    if (with_pose) {
      table +=
          fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} of {} | {} | {:.1f} |\n",
                      f.name, corner(f.corner_rms_px), pose(f.pose_corner_rms_px),
                      pose(f.tip_rms_mm), pose(f.tip_median_mm), pose(f.tip_largest_mm),
                      Cell("{:+.3f}", f.depth_bias_mm, f.poses > f.false_poses),
                      pose(f.turn_rms_deg), found, f.poses, f.pictures, f.false_poses, f.ms);
    } else {
      table += fmt::format("| {} | {} | {} | {} | {:.1f} |\n", f.name, corner(f.corner_rms_px),
                           found, f.false_tags, f.ms);
    }
  }
  return table;
}

std::string CompareJson(const std::vector<CompareRow>& rows) {
  nlohmann::json all = nlohmann::json::array();
  for (const CompareRow& row : rows) {
    nlohmann::json one = {{"sweep", row.sweep}, {"value", row.value}, {"unit", row.unit}};
    for (const PeerFigures& f : row.peers) {
      const auto measured = [](double v, bool is) {
        return is ? nlohmann::json(v) : nlohmann::json();
      };
      const auto corner = [&](double v) { return measured(v, f.tags_found > 0); };
      const auto pose = [&](double v) { return measured(v, f.poses > f.false_poses); };
      one["peers"][f.name] = {{"corner_rms_px", corner(f.corner_rms_px)},
                              {"pose_corner_rms_px", pose(f.pose_corner_rms_px)},
                              {"tip_rms_mm", pose(f.tip_rms_mm)},
                              {"tip_median_mm", pose(f.tip_median_mm)},
                              {"tip_largest_mm", pose(f.tip_largest_mm)},
                              {"depth_bias_mm", pose(f.depth_bias_mm)},
                              {"turn_rms_deg", pose(f.turn_rms_deg)},
                              {"pictures", f.pictures},
                              {"tags", f.tags},
                              {"tags_found", f.tags_found},
                              {"false_tags", f.false_tags},
                              {"recall", f.Recall()},
                              {"poses", f.poses},
                              {"false_poses", f.false_poses},
                              {"ms", f.ms}};
    }
    all.push_back(one);
  }
  return all.dump(2) + "\n";
}

std::vector<Plot> ComparePlots(const std::vector<CompareRow>& rows, const std::string& y_label,
                               double (*figure)(const PeerFigures&), bool log_y) {
  std::vector<Plot> plots;
  for (const CompareRow& row : rows) {
    auto plot = std::find_if(plots.begin(), plots.end(),
                             [&](const Plot& p) { return p.title == row.sweep; });
    if (plot == plots.end()) {
      plot = plots.insert(plots.end(), {row.sweep, row.unit, y_label, log_y, {}});
    }
    for (const PeerFigures& f : row.peers) {
      auto line = std::find_if(plot->lines.begin(), plot->lines.end(),
                               [&](const PlotLine& l) { return l.name == f.name; });
      if (line == plot->lines.end()) line = plot->lines.insert(plot->lines.end(), {f.name, {}});
      line->points.emplace_back(row.value, figure(f));
    }
  }
  return plots;
}

}  // namespace flextip
