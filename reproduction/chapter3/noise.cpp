#include "reproduction/chapter3/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "control/motion_error.h"
#include "core/median.h"

namespace flextip::reproduction {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Measure = double EstimateErrors::*;
constexpr Measure kMeasures[] = {&EstimateErrors::metric, &EstimateErrors::force,
                                 &EstimateErrors::port_m};

bool OnShaft(const BeamState& state) { return state.a > 0.0 && state.a < state.length_m; }

/// Climbs from `start` (each axis in parts of its bound) by steps along the axes, halved when none
/// of them climbs.
double Climb(FlexionForm form, const BeamState& truth, const BeamReadings& bounds,
             BeamReadings start, Measure measure) {
  const BeamReadings right = ReadingsOf(truth);
  const auto value = [&](const BeamReadings& parts) {
    const BeamReadings readings = right + parts.cwiseProduct(bounds);
    return ErrorsOf(form, truth, EstimateBeam(readings, truth.length_m)).*measure;
  };
  double best = value(start);
  for (double step = 0.5; step > 1e-3;) {
    bool climbed = false;
    for (int i = 0; i < 12; ++i) {
      BeamReadings next = start;
      next[i / 2] = std::clamp(next[i / 2] + (i % 2 == 0 ? step : -step), -1.0, 1.0);
      const double there = value(next);
      if (!(there > best)) continue;
      best = there;
      start = next;
      climbed = true;
    }
    if (!climbed) step *= 0.5;
  }
  return best;
}

}  // namespace

BeamReadings SensorNoiseLevel::Bounds() const {
  BeamReadings bounds;
  bounds << Eigen::Vector4d::Constant(position_m), Eigen::Vector2d::Constant(angle_rad);
  return bounds;
}

EstimateErrors ErrorsOf(FlexionForm form, const BeamState& truth, const BeamState& estimate) {
  EstimateErrors errors;
  errors.metric = errors.force = errors.port_m = kInfinity;
  if (!std::isfinite(estimate.a) || !std::isfinite(estimate.F)) return errors;
  errors.force = std::abs(estimate.F / truth.F - 1.0);
  errors.port_m = (estimate.Port() - truth.Port()).norm();
  if (!OnShaft(estimate)) return errors;  // no Jacobian
  errors.metric = FindStepError(FlexionJacobian(form, truth), FlexionJacobian(form, estimate)).norm;
  return errors;
}

WorstErrors WorstOverNoise(FlexionForm form, const BeamState& truth,
                           const SensorNoiseLevel& bound) {
  const BeamReadings right = ReadingsOf(truth), bounds = bound.Bounds();
  const double side = FlexionJacobian(form, truth).determinant();
  WorstErrors result;
  BeamReadings at[3];
  bool port_leaves = false, singular = false;
  for (int number = 0; number < 729; ++number) {
    BeamReadings parts;
    for (int i = 0, rest = number; i < 6; ++i, rest /= 3) parts[i] = rest % 3 - 1;
    const BeamState estimate = EstimateBeam(right + parts.cwiseProduct(bounds), truth.length_m);
    const EstimateErrors errors = ErrorsOf(form, truth, estimate);
    port_leaves |= !OnShaft(estimate);
    singular |= !OnShaft(estimate) || FlexionJacobian(form, estimate).determinant() * side <= 0.0;
    const bool corner = parts.cwiseAbs().minCoeff() > 0.5;
    for (int i = 0; i < 3; ++i) {
      const Measure m = kMeasures[i];
      if (corner) result.corners.*m = std::max(result.corners.*m, errors.*m);
      if (errors.*m < result.worst.*m) continue;
      result.worst.*m = errors.*m;
      at[i] = parts;
    }
  }
  for (int i = 0; i < 3; ++i)
    result.worst.*kMeasures[i] = Climb(form, truth, bounds, at[i], kMeasures[i]);
  if (port_leaves) result.worst.force = kInfinity;
  if (singular) result.worst.metric = kInfinity;
  return result;
}

TypicalMetric MetricUnderGaussianNoise(FlexionForm form, const BeamState& truth,
                                       const SensorNoiseLevel& sd, int draws, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  const BeamReadings right = ReadingsOf(truth);
  std::vector<double> metrics;
  double squares = 0.0, sum = 0.0;
  for (int i = 0; i < draws; ++i) {
    const BeamReadings parts = BeamReadings::NullaryExpr([&] { return normal(rng); });
    const BeamState estimate =
        EstimateBeam(right + parts.cwiseProduct(sd.Bounds()), truth.length_m);
    const double metric = ErrorsOf(form, truth, estimate).metric;
    if (!std::isfinite(metric)) continue;
    metrics.push_back(metric);
    sum += metric;
    squares += metric * metric;
  }
  const double count = static_cast<double>(metrics.size());
  return {Median(metrics), std::sqrt(squares / count), sum / count};
}

}  // namespace flextip::reproduction
