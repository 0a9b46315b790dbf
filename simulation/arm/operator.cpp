#include "simulation/arm/operator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/draw_vector.h"

namespace flextip::simulation {
namespace {

constexpr double kPressingMemory_s = 2.0;  // of the wandering of the pressing
constexpr double kTremorDamping = 0.05;    // relative: half of the power within 0.5 Hz
constexpr double kApproach_s = 1.0;
constexpr double kVisitedStep_m = 0.002;
constexpr int kCandidates = 12;

double Drawn(std::mt19937_64& rng, double mean, double sd, double low, double high) {
  return std::clamp(std::normal_distribution<double>(mean, sd)(rng), low, high);
}

/// 0 to 1 with the least jerk.
double MinimumJerk(double u) { return u * u * u * (10.0 + u * (-15.0 + 6.0 * u)); }

}  // namespace

OperatorTraits DrawOperator(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  OperatorTraits traits;
  traits.speed_m_s = Drawn(rng, 0.015, 0.004, 0.007, 0.025);
  traits.tremor_m = Drawn(rng, 1.5e-4, 0.5e-4, 0.5e-4, 3e-4);
  traits.tremor_hz = Drawn(rng, 10.0, 1.0, 8.0, 12.0);
  traits.pressing_m = Drawn(rng, 0.006, 0.002, 0.002, 0.010);
  traits.pressing_change_m = Drawn(rng, 0.003, 0.001, 0.001, 0.005);
  traits.delay_s = Drawn(rng, 0.2, 0.03, 0.12, 0.3);
  traits.correction_1_s = Drawn(rng, 2.0, 0.4, 1.0, 3.0);
  return traits;
}

SimulatedOperator::SimulatedOperator(const OperatorTask& task, const OperatorTraits& traits,
                                     std::uint64_t seed)
    : task_(task), traits_(traits), rng_(seed) {
  visited_.push_back(plan_);
}

/// Strokes lead to the least visited of some places in the outline.
void SimulatedOperator::ChooseTarget() {
  std::uniform_real_distribution<double> uniform;
  double farthest = -1.0;
  for (int i = 0; i < kCandidates; ++i) {
    const double radius = task_.outline_radius_m * std::sqrt(uniform(rng_));
    const double angle = 2.0 * std::numbers::pi * uniform(rng_);
    const Eigen::Vector2d place = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    double nearest = (place - plan_).norm();
    for (const Eigen::Vector2d& was : visited_) nearest = std::min(nearest, (place - was).norm());
    if (nearest <= farthest) continue;
    farthest = nearest;
    to_ = place;
  }
  from_ = plan_;
  stroke_s_ = std::max((to_ - from_).norm() / traits_.speed_m_s, 0.2);
  stroke_done_s_ = 0.0;
}

void SimulatedOperator::MovePlan(double dt_s) {
  if (t_s_ < kApproach_s) return;
  if (stroke_done_s_ >= stroke_s_) ChooseTarget();
  stroke_done_s_ += dt_s;
  const double part = MinimumJerk(std::min(1.0, stroke_done_s_ / stroke_s_));
  plan_ = from_ + part * (to_ - from_);
  if ((plan_ - visited_.back()).norm() > kVisitedStep_m) visited_.push_back(plan_);
}

Eigen::Vector3d SimulatedOperator::At(const Eigen::Vector2d& plan) const {
  // Along the surface as the monitor's axes show it.
  const auto along = [&](const Eigen::Vector3d& axis) -> Eigen::Vector3d {
    return (axis - task_.inward.dot(axis) * task_.inward).normalized();
  };
  return task_.p_centre + plan.x() * along(task_.right) + plan.y() * along(task_.up);
}

/// The monitor shows where the tip is from where it was meant to be, without depth: a tip that is
/// too deep looks too high or low. The hand takes it back at a rate.
void SimulatedOperator::Correct(double dt_s, const Eigen::Vector3d& p_tip) {
  const Eigen::Vector3d off = p_tip - At(plan_);
  const double foreshortening =
      std::sqrt(1.0 - std::pow(task_.inward.dot(task_.up), 2));  // of the surface, upward
  seen_.push_back({t_s_, plan_, {task_.right.dot(off), task_.up.dot(off) / foreshortening}});
  if (seen_.front().t_s > t_s_ - traits_.delay_s) return;
  if (t_s_ > kApproach_s) correction_ -= dt_s * traits_.correction_1_s * seen_.front().offset;
  const double most = 2.0 * task_.outline_radius_m;
  if (correction_.norm() > most) correction_ *= most / correction_.norm();
  seen_.pop_front();
}

/// White noise through a resonance at the tremor's frequency, scaled to the RMS.
Eigen::Vector3d SimulatedOperator::Tremor(double dt_s) {
  const double omega = 2.0 * std::numbers::pi * traits_.tremor_hz;
  const double drive = traits_.tremor_m * std::sqrt(4.0 * kTremorDamping * std::pow(omega, 3));
  constexpr int kParts = 4;  // of a step: the resonance is integrated with less than 0.1 rad each
  const double h = dt_s / kParts;
  for (int i = 0; i < kParts; ++i) {
    const Eigen::Vector3d kick = DrawVector<3>(normal_, rng_);
    tremor_rate_ += -h * (omega * omega * tremor_ + 2.0 * kTremorDamping * omega * tremor_rate_) +
                    std::sqrt(h) * drive * kick;
    tremor_ += h * tremor_rate_;
  }
  return tremor_;
}

Eigen::Vector3d SimulatedOperator::Step(double dt_s, const Eigen::Vector3d& p_tip) {
  t_s_ += dt_s;
  MovePlan(dt_s);
  Correct(dt_s, p_tip);
  const double forgotten = dt_s / kPressingMemory_s;
  pressing_ += -forgotten * pressing_ +
               std::sqrt(2.0 * forgotten) * traits_.pressing_change_m * normal_(rng_);
  const double in = MinimumJerk(std::min(1.0, t_s_ / kApproach_s));
  const double depth = -(1.0 - in) * task_.approach_m + in * (traits_.pressing_m + pressing_);
  return At(plan_ + correction_) + depth * task_.inward + Tremor(dt_s);
}

}  // namespace flextip::simulation
