#include "calibration/clock/predictors.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr double kFineStep_s = 0.002, kCoarseStep_s = 0.01;
constexpr double kMostInstants = 1e5;
// Ways of sliding through the port over which friction turns round.
constexpr double kStick_m[] = {2e-4, 1e-3, 4e-3};
constexpr int kSticks = 3;
// Times over which tissue along the shaft gives way.
constexpr double kYield_s[] = {0.4, 2.0};
constexpr int kYields = 2;

/// A play of full width `width`: follows `driver` at a distance of half of it at most.
double Follow(double follower, double driver, double width) {
  return std::clamp(follower, driver - 0.5 * width, driver + 0.5 * width);
}

Eigen::Vector3d StraightTip(const WristPort& port, const Eigen::Vector3d& p_RW) {
  const Eigen::Vector3d along = port.p_RP - p_RW;
  const double length = along.norm();
  return length > 0.0 ? Eigen::Vector3d(p_RW + port.length_m / length * along) : p_RW;
}

}  // namespace

Predictors::Predictors(const Motion& reference)
    : reference_(reference), smooth_(reference, UsualBandwidth(reference)) {
  first_s_ = smooth_.BeginSeconds();
  const double span_s = std::max(0.0, smooth_.EndSeconds() - first_s_);
  step_s_ = std::clamp(span_s / kMostInstants, kFineStep_s, kCoarseStep_s);
  const auto instants = static_cast<Eigen::Index>(std::floor(span_s / step_s_)) + 1;
  // A wrist's straight tip follows from the wrist.
  const Eigen::Index rows = HasPlay() ? 3 : reference.values.rows();
  const Eigen::Index from = HasPlay() ? reference.values.rows() - 3 : 0;
  base_ = Eigen::MatrixXd::Zero(rows, instants);
  known_.assign(static_cast<std::size_t>(instants), false);
  Eigen::VectorXd value, velocity;
  for (Eigen::Index k = 0; k < instants; ++k) {
    if (smooth_.At(first_s_ + step_s_ * static_cast<double>(k), value, velocity)) {
      base_.col(k) = value.segment(from, rows);
      known_[static_cast<std::size_t>(k)] = true;
    } else if (k > 0) {
      base_.col(k) = base_.col(k - 1);
    }
  }
  middle_ = base_.rowwise().mean();
  size_ = (base_.colwise() - middle_).rowwise().norm() /
          std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, instants)));
  size_ = size_.cwiseMax(1e-12);
  const Eigen::Index n = std::min<Eigen::Index>(rows, reference.own_rows);
  const Eigen::Index linear = HasPlay() ? 6 : rows;
  kinds_ = {{0, linear}};
  const auto add = [&](Eigen::Index count) {
    kinds_.push_back({kinds_.back().first + kinds_.back().count, count});
  };
  add(n * (n + 1) / 2);
  if (n == 3) add(10);
  if (HasPlay()) {
    add(4 * kSticks);
    add(3 * kYields);
  }
  SetPlay(0.0);
}

void Predictors::SetPlay(double width_m) {
  if (!HasPlay()) {
    course_ = base_;
    return;
  }
  course_.resize(3 + kSticks + 3 * kYields, base_.cols());
  Eigen::Vector3d moved = base_.col(0);
  double stuck[kSticks];
  std::fill(stuck, stuck + kSticks, (reference_.port->p_RP - moved).norm());
  Eigen::Matrix<double, 3, kYields> slow = moved.replicate<1, kYields>();
  double gives_way[kYields];
  for (int i = 0; i < kYields; ++i) gives_way[i] = 1.0 - std::exp(-step_s_ / kYield_s[i]);
  for (Eigen::Index k = 0; k < base_.cols(); ++k) {
    for (int i = 0; i < 3; ++i) moved[i] = Follow(moved[i], base_(i, k), width_m);
    course_.col(k).head<3>() = moved;
    const double depth = (reference_.port->p_RP - moved).norm();
    for (int i = 0; i < kSticks; ++i) {
      stuck[i] = Follow(stuck[i], depth, kStick_m[i]);
      course_(3 + i, k) = (depth - stuck[i]) / (0.5 * kStick_m[i]);
    }
    for (int i = 0; i < kYields; ++i) {
      slow.col(i) += gives_way[i] * (moved - slow.col(i));
      course_.col(k).segment<3>(3 + kSticks + 3 * i) =
          (moved - slow.col(i)).cwiseQuotient(size_.head<3>());
    }
  }
}

void Predictors::Features(const Eigen::VectorXd& at, Eigen::VectorXd& f) const {
  f.resize(Count());
  const Eigen::Index n = std::min<Eigen::Index>(base_.rows(), reference_.own_rows);
  if (HasPlay()) {
    f.head<6>() << StraightTip(*reference_.port, at.head<3>()), at.head<3>();
  } else {
    f.head(base_.rows()) = at.head(base_.rows());
  }
  const Eigen::VectorXd x = (at.head(n) - middle_.head(n)).cwiseQuotient(size_.head(n));
  Eigen::Index k = kinds_[0].count;
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = a; b < n; ++b) f[k++] = x[a] * x[b];
  if (n == 3) {
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = a; b < n; ++b)
        for (Eigen::Index c = b; c < n; ++c) f[k++] = x[a] * x[b] * x[c];
  }
  if (HasPlay()) {
    for (int i = 0; i < kSticks; ++i) {
      f[k++] = at[3 + i];
      for (int a = 0; a < 3; ++a) f[k++] = at[3 + i] * x[a];
    }
    f.tail(3 * kYields) = at.tail(3 * kYields);
  }
}

bool Predictors::At(double t_s, Eigen::VectorXd& value, Eigen::VectorXd* velocity) const {
  const double instant = (t_s - first_s_) / step_s_;
  if (!(instant >= 1.0) || instant >= static_cast<double>(base_.cols() - 2)) return false;
  const auto k = static_cast<Eigen::Index>(instant);
  const auto known = static_cast<std::size_t>(k);
  if (!known_[known - 1] || !known_[known] || !known_[known + 1] || !known_[known + 2]) {
    return false;
  }
  const double u = instant - static_cast<double>(k);
  const Eigen::VectorXd at = (1.0 - u) * course_.col(k) + u * course_.col(k + 1);
  const Eigen::VectorXd per_step = 0.5 * ((1.0 - u) * (course_.col(k + 1) - course_.col(k - 1)) +
                                          u * (course_.col(k + 2) - course_.col(k)));
  Features(at, value);
  if (velocity == nullptr) return true;
  constexpr double kPart = 0.1;  // of a step
  Eigen::VectorXd before;
  Features(at + kPart * per_step, *velocity);
  Features(at - kPart * per_step, before);
  *velocity = (*velocity - before) / (2.0 * kPart * step_s_);
  return true;
}

}  // namespace flextip
