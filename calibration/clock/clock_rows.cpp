#include "calibration/clock/clock_rows.h"

#include "calibration/clock/residual_noise.h"

namespace flextip {

ClockRows GatherRows(const Motion& target, Predictors& reference, const ClockPoint& point,
                     double origin_s, bool with_play) {
  constexpr double kPlayStep_m = 2e-5;
  const auto all = static_cast<Eigen::Index>(target.Count());
  const Eigen::Index features = reference.Count();
  Eigen::MatrixXd x(features, all), v(features, all), p(features, with_play ? all : 0);
  std::vector<Eigen::Index> samples;
  Eigen::VectorXd value, velocity;
  const auto time = [&](Eigen::Index i) {
    const double t = target.t_s[static_cast<std::size_t>(i)];
    return t + point[0] + point[1] * (t - origin_s);
  };
  reference.SetPlay(point[2]);
  for (Eigen::Index i = 0; i < all; ++i) {
    if (!reference.At(time(i), value, &velocity)) continue;
    const auto n = static_cast<Eigen::Index>(samples.size());
    x.col(n) = value;
    v.col(n) = velocity;
    samples.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(samples.size());
  if (with_play) {
    reference.SetPlay(point[2] + kPlayStep_m);
    for (Eigen::Index n = 0; n < count; ++n) {
      reference.At(time(samples[static_cast<std::size_t>(n)]), value, nullptr);
      p.col(n) = (value - x.col(n)) / kPlayStep_m;
    }
  }
  ClockRows rows;
  rows.x = x.leftCols(count).transpose();
  rows.velocity = v.leftCols(count).transpose();
  if (with_play) rows.by_play = p.leftCols(count).transpose();
  rows.y.resize(count, target.own_rows);
  rows.since_s.resize(count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::Index i = samples[static_cast<std::size_t>(n)];
    rows.y.row(n) = target.values.col(i).head(target.own_rows).transpose();
    rows.t_s.push_back(target.t_s[static_cast<std::size_t>(i)]);
    rows.since_s[n] = rows.t_s.back() - origin_s;
  }
  rows.before = WithoutGap(rows.t_s, target.PeriodSeconds());
  return rows;
}

}  // namespace flextip
