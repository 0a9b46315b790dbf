#include "stops/sensor_tips.h"

#include <cmath>

#include "core/time_series.h"
#include "pipeline/guard/sensor_vote.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {
namespace {

constexpr double kUnknown_m = 0.005;  // a tip that is known no better is not shown

EstimatorOptions OptionsOf(EstimatorOptions options) {
  options.use_positions = true;
  options.estimate_tissue = false;
  return options;
}

template <std::size_t... I>
std::array<ShaftEstimator, sizeof...(I)> Estimators(const EstimatorOptions& options,
                                                    std::index_sequence<I...>) {
  return {((void)I, ShaftEstimator(options))...};
}

std::array<ShaftEstimator, kVotedSensors> Estimators(const EstimatorOptions& options) {
  return Estimators(options, std::make_index_sequence<kVotedSensors>());
}

bool Fits(const ShaftEstimate& estimate) {
  return estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
}

}  // namespace

SensorTips::SensorTips(const EstimatorOptions& options, std::unique_ptr<InstrumentModel> model)
    : model_(std::move(model)),
      alone_(Estimators(OptionsOf(options))),
      without_(Estimators(OptionsOf(options))) {}

void SensorTips::Take(TimeNs t_ns, const SensorReadings& readings, const Eigen::Vector3d& f_tip_N) {
  z_ = Gather(readings);
  if (!z_ || !model_) return;
  model_->Advance(t_ns, *z_, f_tip_N);
  z_ = model_->Correct(*z_);
}

std::uint8_t SensorTips::Sensors() const { return z_ ? SensorsOf(*z_) : 0; }

std::optional<Eigen::Vector3d> SensorTips::By(VotedSensor sensor) {
  if (!z_ || (SensorsOf(*z_) >> static_cast<int>(sensor) & 1) == 0) return {};
  if (sensor == VotedSensor::kTip) return z_->tip->p_RE;
  if (sensor == VotedSensor::kPortDirection || sensor == VotedSensor::kWristTurn) return {};
  Measurements z = *z_;
  for (int i = 0; i < kVotedSensors; ++i) {
    const auto other = static_cast<VotedSensor>(i);
    // Gages measure about the wrist's own axes.
    if (other != sensor && other != VotedSensor::kWristTurn) Drop(other, z);
  }
  const ShaftEstimate estimate =
      alone_[static_cast<std::size_t>(sensor)].Update(z, model_ ? model_->Shaft() : ShaftChange());
  if (!Fits(estimate) || MaxSd(estimate.p_RE_covariance_m2) > kUnknown_m) return {};
  return estimate.p_RE;
}

SensorTips::Rest SensorTips::Without(VotedSensor sensor) {
  if (!z_) return {};
  Measurements z = *z_;
  Drop(sensor, z);
  const ShaftEstimate estimate = without_[static_cast<std::size_t>(sensor)].Update(
      z, model_ ? model_->Shaft() : ShaftChange());
  Rest rest;
  rest.fitted = Fits(estimate);
  rest.chi2 = estimate.chi2;
  if (rest.fitted && MaxSd(estimate.p_RE_covariance_m2) < kUnknown_m) rest.p_RE = estimate.p_RE;
  return rest;
}

}  // namespace flextip
