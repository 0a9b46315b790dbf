#include "simulation/faults/sample_fault.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/sensors/sensors.h"

namespace flextip::simulation {
namespace {

using Figures = Eigen::Map<Eigen::VectorXd>;

constexpr std::size_t kHistory = 256;  // samples
constexpr double kSpikesPart = 0.2;
constexpr double kMetal_m = 0.1;  // from the sensor to the place where the field is right

Figures FiguresOf(WristMeasurement& wrist) { return {wrist.p_RW.data(), 3}; }
Figures FiguresOf(TipMeasurement& tip) { return {tip.tip.p_RE.data(), 3}; }
Figures FiguresOf(EmMeasurement& em) { return {em.T_RS.p.data(), 3}; }
Figures FiguresOf(StrainMeasurement& strain) { return {strain.moments_Nm.data(), 4}; }
Figures FiguresOf(LoadMeasurement& load) { return {load.f_tip_N.data(), 3}; }

Eigen::VectorXd DrawDirection(Eigen::Index size, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd direction(size);
  for (double& x : direction) x = normal(rng);
  return direction.normalized();
}

void SwapAxes(int which, Figures figures) {
  if (figures.size() == 4) {
    std::swap(figures[0], figures[1]);
    std::swap(figures[2], figures[3]);
  } else {
    std::swap(figures[which == 0 ? 1 : 0], figures[which == 1 ? 1 : 2]);
  }
}

}  // namespace

template <class M>
SampleFault<M>::SampleFault(const Fault& fault, std::uint64_t seed) : fault_(fault), rng_(seed) {
  M one{};
  direction_ = DrawDirection(FiguresOf(one).size(), rng_);
  other_direction_ = direction_;
}

template <class M>
void SampleFault<M>::Disturb(double t_s, std::optional<Sample<M>>& sample) {
  if (!sample) return;
  const bool is_new = history_.empty() || sample->t_ns != history_.back().t_ns;
  if (is_new) {
    history_.push_back(*sample);
    if (history_.size() > kHistory) history_.pop_front();
    draw_ = std::uniform_real_distribution<double>()(rng_);
    other_direction_ = DrawDirection(direction_.size(), rng_);
  }
  if (!fault_.IsActive(t_s)) return;
  if (is_new || count_ == 0) ++count_;
  if (fault_.kind <= FaultKind::kNotFinite) {
    ActOnFigures(t_s, *sample);
  } else if (fault_.kind <= FaultKind::kOtherClock) {
    ActOnOrder(t_s, *sample);
  } else {
    ActOnSensor(*sample);
  }
}

template <class M>
void SampleFault<M>::ActOnFigures(double t_s, Sample<M>& sample) {
  Figures figures = FiguresOf(sample.value);
  switch (fault_.kind) {
    case FaultKind::kStuck:
      if (!held_) held_ = sample;
      sample.value = held_->value;
      break;
    case FaultKind::kSpike:
      if (count_ == 1) figures += fault_.size * direction_;
      break;
    case FaultKind::kSpikes:
      if (draw_ < kSpikesPart) figures += fault_.size * other_direction_;
      break;
    case FaultKind::kOffset:
      figures += fault_.size * direction_;
      break;
    case FaultKind::kDrift:
      figures += fault_.size * (t_s - fault_.start_s) * direction_;
      break;
    case FaultKind::kScale:
    case FaultKind::kUnits:
      figures *= fault_.size;
      break;
    case FaultKind::kSwappedAxes:
      SwapAxes(static_cast<int>(fault_.size), figures);
      break;
    default:
      figures.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

/// By the samples of the past.
template <class M>
void SampleFault<M>::ActOnOrder(double t_s, Sample<M>& sample) {
  const auto older = [this](std::size_t by) -> const Sample<M>& {
    return history_[history_.size() - 1 - std::min(by, history_.size() - 1)];
  };
  const TimeNs start_ns = kSimulationStart_ns + std::llround(1e9 * fault_.start_s);
  const auto whole = static_cast<std::size_t>(std::max(0.0, fault_.size));
  switch (fault_.kind) {
    case FaultKind::kDelayed: {
      const TimeNs until_ns = kSimulationStart_ns + std::llround(1e9 * (t_s - fault_.size));
      std::size_t by = 0;
      while (by + 1 < history_.size() && older(by).t_ns > until_ns) ++by;
      sample = older(by);
      break;
    }
    case FaultKind::kDropped:
      if (!held_) held_ = older(1);
      if (draw_ >= fault_.size) held_ = sample;
      sample = *held_;
      break;
    case FaultKind::kRepeated:
      if (static_cast<std::size_t>(count_ - 1) % (whole + 1) == 0) held_ = sample;
      sample = *held_;
      break;
    case FaultKind::kOutOfOrder:
      if (count_ % 2 == 0) sample = older(whole);
      break;
    case FaultKind::kStampJump:
      sample.t_ns += std::llround(1e9 * fault_.size);
      break;
    default:
      sample.t_ns =
          start_ns + std::llround(fault_.size * static_cast<double>(sample.t_ns - start_ns));
  }
}

template <>
void SampleFault<TipMeasurement>::ActOnSensor(Sample<TipMeasurement>& sample) {
  TipObservation& tip = sample.value.tip;
  if (fault_.kind == FaultKind::kTagsCovered) {
    tip = {};
  } else if (fault_.kind == FaultKind::kWrongTag) {
    tip.p_RE += fault_.size * tip.d_RE.value_or(direction_.head<3>());
  } else {
    if (!held_) held_ = sample;
    if (draw_ < 0.5) tip.p_RE = held_->value.tip.p_RE + fault_.size * direction_;
  }
}

/// The field is bent by `size` where the sensor is at first, by less toward a place 0.1 m aside.
template <>
void SampleFault<EmMeasurement>::ActOnSensor(Sample<EmMeasurement>& sample) {
  Eigen::Vector3d& p = sample.value.T_RS.p;
  if (!field_) {
    const Eigen::Vector3d towards = direction_;
    const Eigen::Matrix3d gradient = fault_.size / kMetal_m * towards * towards.transpose();
    field_.emplace(gradient, p - kMetal_m * towards, 0.0);
  }
  p += field_->Bias(p);
}

template <>
void SampleFault<StrainMeasurement>::ActOnSensor(Sample<StrainMeasurement>& sample) {
  Eigen::Index channel = 0;
  direction_.cwiseAbs().maxCoeff(&channel);
  sample.value.moments_Nm[channel] = fault_.size;
}

template <class M>
void SampleFault<M>::ActOnSensor(Sample<M>&) {}

template class SampleFault<WristMeasurement>;
template class SampleFault<TipMeasurement>;
template class SampleFault<EmMeasurement>;
template class SampleFault<StrainMeasurement>;
template class SampleFault<LoadMeasurement>;

}  // namespace flextip::simulation
