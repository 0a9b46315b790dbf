#include "estimation/window_port.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "estimation/saved_state.h"

namespace flextip {
namespace {

constexpr int kEvaluations = 4;
constexpr double kLongestStep = 0.5;  // of a force, in units of EI / L^2
constexpr double kSmallGain = 1e-3;   // of chi2

Eigen::Matrix3d PriorCovariance(double prior_m) {
  return prior_m * prior_m * Eigen::Matrix3d::Identity();
}

}  // namespace

WindowPort::WindowPort(int samples, double prior_m, bool use_positions)
    : capacity_(samples),
      prior_m_(std::max(prior_m, 1e-6)),
      use_positions_(use_positions),
      samples_(std::size_t(samples) + 1),
      parts_(std::size_t(samples) + 1),
      covariance_m2_(PriorCovariance(prior_m_)) {
  FLEXTIP_CHECK(samples >= 1, "a window has a sample");
}

void WindowPort::Reset() {
  size_ = 0;
  shift_m_.setZero();
  covariance_m2_ = PriorCovariance(prior_m_);
}

void WindowPort::VisitState(StateText& state) {
  state(size_);
  if (size_ < 0 || size_ > capacity_) throw InputError("saved state: no size of a window");
  for (int i = 0; i < size_; ++i) {
    WindowSample& sample = samples_[static_cast<std::size_t>(i)];
    state(sample.measurements);
    flextip::VisitState(sample.shaft, state);
    state(sample.prior.mean);
    state(sample.prior.sd);
    state(sample.prior.port_whitening);
    state(sample.own);
    state(sample.solver);
    state(sample.number);
  }
  state(shift_m_);
  state(covariance_m2_);
  state(cost_);
}

void WindowPort::Remove(int index) {
  --size_;
  if (index != size_) std::swap(samples_[index], samples_[size_]);
}

void WindowPort::Add(const WindowSample& sample) {
  samples_[size_++] = sample;
  if (size_ <= capacity_) return;
  double nearest = std::numeric_limits<double>::infinity();
  int dropped = 0;
  for (int i = 0; i < size_; ++i) {
    for (int j = 0; j < i; ++j) {
      const double distance2 =
          (samples_[i].measurements.p_RW - samples_[j].measurements.p_RW).squaredNorm();
      if (distance2 >= nearest) continue;
      nearest = distance2;
      dropped = samples_[i].number < samples_[j].number ? i : j;
    }
  }
  Remove(dropped);
}

bool WindowPort::Linearise(WindowSample& sample, Part& part, Sum& sum) const {
  RodFit fit(sample.shaft, sample.measurements, sample.prior, use_positions_, sample.solver);
  RodParameters x;
  x << sample.own.head<3>(), sample.prior.mean.segment<3>(3) + shift_m_, sample.own.tail<3>();
  RodFit::Residuals r;
  RodFit::Jacobian J;
  if (!fit(x.data(), r.data(), J.data())) return false;
  Eigen::Matrix<double, RodFit::NUM_RESIDUALS, 6> J_own;
  J_own << J.leftCols<3>(), J.rightCols<3>();
  const auto J_port = J.middleCols<3>(3);
  part.own = Llt<6>(J_own.transpose() * J_own);
  part.mixed = J_own.transpose() * J_port;
  part.gradient = J_own.transpose() * r;
  sum.cost += r.squaredNorm();
  sum.information +=
      J_port.transpose() * J_port - part.mixed.transpose() * part.own.Solve(part.mixed);
  sum.gradient += J_port.transpose() * r - part.mixed.transpose() * part.own.Solve(part.gradient);
  return true;
}

bool WindowPort::LineariseAll(Sum& sum) {
  const double weight = 1.0 / (prior_m_ * prior_m_);
  sum = {weight * shift_m_.squaredNorm(), weight * Eigen::Matrix3d::Identity(), weight * shift_m_};
  for (int i = 0; i < size_; ++i) {
    if (!Linearise(samples_[i], parts_[i], sum)) return false;
  }
  return size_ > 0;
}

void WindowPort::DropUnsolvable() {
  for (int i = size_ - 1; i >= 0; --i) {
    Sum ignored;
    if (!Linearise(samples_[i], parts_[i], ignored)) Remove(i);
  }
}

void WindowPort::ProposeStep(const Sum& sum) {
  shift_before_m_ = shift_m_;
  shift_step_m_ = -Ldlt(sum.information).Solve(sum.gradient);
  for (int i = 0; i < size_; ++i) {
    Part& part = parts_[i];
    part.before = samples_[i].own;
    part.step = -part.own.Solve(part.gradient + part.mixed * shift_step_m_);
    const double force = part.step.tail<3>().norm();
    if (force > kLongestStep) part.step *= kLongestStep / force;
  }
}

void WindowPort::MoveAlong(double fraction) {
  shift_m_ = shift_before_m_ + fraction * shift_step_m_;
  for (int i = 0; i < size_; ++i) samples_[i].own = parts_[i].before + fraction * parts_[i].step;
}

bool WindowPort::Refine() {
  Sum sum;
  if (!LineariseAll(sum)) {
    DropUnsolvable();
    if (!LineariseAll(sum)) return false;
  }
  ProposeStep(sum);
  double fraction = 1.0;
  for (int i = 1; i < kEvaluations; ++i) {
    MoveAlong(fraction);
    Sum next;
    if (!LineariseAll(next) || next.cost > sum.cost) {
      fraction *= 0.3;
      MoveAlong(0.0);  // in case it was the last try
      continue;
    }
    const double gained = sum.cost - next.cost;
    sum = next;
    ProposeStep(sum);
    fraction = 1.0;
    if (gained < kSmallGain) break;
  }
  covariance_m2_ = sum.information.inverse();
  cost_ = sum.cost;
  return size_ > 0;
}

}  // namespace flextip
