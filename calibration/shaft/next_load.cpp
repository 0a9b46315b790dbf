#include "calibration/shaft/next_load.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rotation.h"

namespace flextip {
namespace {

/// Along the shaft and two across it, and what those two are called.
struct ShaftAxes {
  Eigen::Matrix3d R;
  std::string names[2];
};

ShaftAxes AxesOf(const LoadHold& hold, const Eigen::Vector3d& p_RP) {
  if (hold.R_RW) return {*hold.R_RW, {"the wrist's y axis", "the wrist's z axis"}};
  ShaftAxes axes;
  axes.R.col(0) = (p_RP - hold.p_RW).normalized();
  axes.R.rightCols<2>() = NormalBasis(axes.R.col(0));
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d a = axes.R.col(1 + i);
    axes.names[i] = fmt::format("({:.2f}, {:.2f}, {:.2f}) in R", a.x(), a.y(), a.z());
  }
  return axes;
}

void AddAt(const PlacedHold& from, double push_m, double force_N, const Eigen::Vector3d& p_RP,
           std::vector<NextLoad>& all) {
  const ShaftAxes axes = AxesOf(from.hold, p_RP);
  NextLoad next{from.hold, ""};
  next.hold.p_RW += push_m * axes.R.col(0);
  const std::string where =
      fmt::format(", with the port {:.3f} m from the wrist", from.s_port_m - push_m);
  next.hold.f_tip_N.setZero();
  next.words = "no load at all" + where;
  all.push_back(next);
  for (const int axis : {0, 1}) {
    for (const double sign : {1.0, -1.0}) {
      next.hold.f_tip_N = sign * force_N * axes.R.col(1 + axis);
      next.words = fmt::format("{:.3g} N {} {}{}", force_N, sign < 0 ? "against" : "along",
                               axes.names[axis], where);
      all.push_back(next);
    }
  }
}

}  // namespace

std::vector<NextLoad> NextLoads(std::vector<PlacedHold> holds, const Eigen::Vector3d& p_RP) {
  std::vector<NextLoad> all;
  if (holds.empty()) return all;
  double force_N = 0;
  for (const auto& h : holds) force_N = std::max(force_N, h.hold.f_tip_N.norm());
  std::sort(holds.begin(), holds.end(),
            [](const auto& a, const auto& b) { return a.s_port_m < b.s_port_m; });
  for (const auto& at : {holds.front(), holds[holds.size() / 2], holds.back()}) {
    for (const double part : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
      AddAt(at, part * at.s_port_m, force_N, p_RP, all);
    }
  }
  return all;
}

}  // namespace flextip
