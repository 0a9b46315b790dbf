#include "vision/photometric/tag_blur.h"

#include <algorithm>
#include <cmath>

#include "core/rotation.h"

namespace flextip {

PatternBlur BlurOnTag(const Eigen::Matrix3d& to_tag, const Eigen::Matrix2d& spread_m, double middle,
                      double depth_m) {
  const Eigen::RowVector2d w = to_tag.bottomLeftCorner<1, 2>();
  const Eigen::Matrix2d lines =
      depth_m * (to_tag.topLeftCorner<2, 2>() - Eigen::Vector2d(middle, middle) * w);
  const Eigen::Matrix2d spread = lines * spread_m * lines.transpose();
  const double su = std::sqrt(spread(0, 0)), sv = std::sqrt(spread(1, 1));
  PatternBlur blur(su, sv, std::clamp(spread(0, 1) / (su * sv), -0.75, 0.75));
  const Eigen::Vector2d rate = depth_m * lines * spread_m * w.transpose();
  blur.rate_u = static_cast<float>(rate[0] / spread(0, 0));
  blur.rate_v = static_cast<float>(rate[1] / spread(1, 1));
  blur.middle = static_cast<float>(middle);
  return blur;
}

SpreadByMotion SpreadOfTag(const Pose& T_CG, const Eigen::Vector3d& pivot_C,
                           const Eigen::Matrix2d& m_of_px, const Eigen::Matrix2d& spread_px) {
  const Eigen::Vector3d p = T_CG.p, n = T_CG.R.col(2);
  const double w = 1 / p.z();
  const Eigen::Vector2d m = w * p.head<2>();
  const Eigen::Vector2d w_by_m = n.head<2>() / n.dot(p);  // of the plane's inverse depth
  Eigen::Matrix<double, 3, 2> p_by_m = -p.z() * p * w_by_m.transpose();
  p_by_m.topRows<2>().diagonal().array() += p.z();
  const Eigen::Matrix2d px_of_m = m_of_px.inverse();
  SpreadByMotion spread;
  for (int i = 0; i < spread.rows(); ++i) {
    const bool turns = i < 3;
    const Eigen::Vector3d axis = i < 6 ? Eigen::Vector3d::Unit(i % 3) : Eigen::Vector3d(-n);
    const Eigen::Vector3d v = turns ? Eigen::Vector3d(axis.cross(p - pivot_C)) : axis;
    Eigen::Matrix<double, 3, 2> v_by_m = Eigen::Matrix<double, 3, 2>::Zero();
    if (turns) v_by_m = Skew(axis) * p_by_m;
    // The flow is w (v_xy - m v_z).
    Eigen::Matrix2d flow_by_m = w * (v_by_m.topRows<2>() - m * v_by_m.row(2)) +
                                (v.head<2>() - m * v.z()) * w_by_m.transpose();
    flow_by_m.diagonal().array() -= w * v.z();
    const Eigen::Matrix2d W = px_of_m * flow_by_m * m_of_px * spread_px;
    spread.row(i) << -2 * W(0, 0), -W(0, 1) - W(1, 0), -2 * W(1, 1);
  }
  return spread;
}

}  // namespace flextip
