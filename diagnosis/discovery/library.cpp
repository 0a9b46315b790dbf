#include "diagnosis/discovery/library.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip::diagnosis {
namespace {

using V = TermVariable;
using S = TermShape;

constexpr int kThresholds = 24;
constexpr double kForceDeviations = 20.0;
constexpr double kFastest_hz = 25.0, kShortest_m = 0.006;
constexpr double kFastestStamp_hz = 1.0;  // faster is jitter, and a slow sensor's alias
constexpr std::size_t kMostWaves = 2500;

/// The values of a variable over the recording, of one component, sorted.
struct Spread {
  std::vector<double> sorted;

  double At(double part) const {
    return sorted[static_cast<std::size_t>(part * double(sorted.size() - 1))];
  }
  double Low() const { return At(0.01); }
  double High() const { return At(0.99); }
  double Range() const { return High() - Low(); }
  bool Varies() const { return Range() > 1e-6 * (1e-3 + std::abs(High())); }
};

double ValueOf(const TermState& state, V variable, int component) {
  switch (variable) {
    case V::kPosition:
      return state.position[component];
    case V::kOrientation:
      return state.orientation[component];
    case V::kImagePosition:
      return state.image[component];
    case V::kOwnValue:
      return state.own[component];
    default:
      return state.scalar[static_cast<std::size_t>(variable)];
  }
}

Spread SpreadOf(const std::vector<TermState>& states, V variable, int component = 0) {
  Spread spread;
  for (const TermState& state : states)
    spread.sorted.push_back(ValueOf(state, variable, component));
  std::sort(spread.sorted.begin(), spread.sorted.end());
  return spread;
}

/// Of a variable with a component an input: about zero, the widest.
double LargestRange(const std::vector<TermState>& states, V variable, int inputs, bool about_zero) {
  double range = 0.0;
  for (int i = 0; i < std::min(inputs, variable == V::kPosition ? 3 : 4); ++i) {
    const Spread spread = SpreadOf(states, variable, i);
    range = std::max(range, about_zero ? std::max(std::abs(spread.Low()), std::abs(spread.High()))
                                       : spread.Range());
  }
  return range;
}

class Grid {
 public:
  Grid(TermTarget target, const std::vector<TermState>& states, const SampleSet& set)
      : target_(target), states_(states), set_(set), inputs_(InfoOf(target).inputs) {}

  std::vector<Term> Make() {
    // Where the port hardly presses, friction times the load cell's noise would be all there is.
    if (target_ == TermTarget::kFriction && set_.has_load &&
        IsNoise(V::kPortForce, SpreadOf(states_, V::kPortForce)))
      return {};
    Add(S::kConstant, V::kTime, {});
    if (IsStamp(target_)) {  // a clock knows of nothing but time
      AddScalar(V::kTime);
      return std::move(terms_);
    }
    for (const V variable : {V::kTime, V::kInsertionDepth, V::kSlidingVelocity, V::kWristSpeed,
                             V::kPortForce, V::kLoad, V::kDistanceToCamera})
      if (Fits(variable)) AddScalar(variable);
    AddVectors();
    AddPlanes();
    if (HasOwnValue()) AddOwnValue();
    if (set_.resolved_in_time && (inputs_ == 3)) AddMemory(V::kPosition);
    if (target_ == TermTarget::kEmPosition || target_ == TermTarget::kEmOrientation) AddPlaces();
    return std::move(terms_);
  }

 private:
  void Add(S shape, V variable, std::vector<double> at) {
    Term term;
    term.target = target_;
    term.shape = shape;
    term.variable = variable;
    term.at = std::move(at);
    terms_.push_back(std::move(term));
  }

  bool IsOfVision() const {
    return target_ == TermTarget::kVisionPosition || target_ == TermTarget::kVisionDirection;
  }
  bool HasOwnValue() const {
    switch (target_) {
      case TermTarget::kPort:
      case TermTarget::kStiffness:
      case TermTarget::kFriction:
      case TermTarget::kShaftLoad:
      case TermTarget::kCurvature:
        return false;
      default:
        return true;
    }
  }
  bool Fits(V variable) const {
    if (variable == V::kDistanceToCamera) return IsOfVision() && set_.has_camera;
    // A force that is found from the sample's own sensors has their noise: any of them would
    // follow it.
    if (variable == V::kPortForce || variable == V::kLoad) return set_.has_load;
    if (variable == V::kSlidingVelocity || variable == V::kWristSpeed || variable == V::kTime)
      return set_.resolved_in_time;
    return true;
  }

  /// A force that hardly stands out of the load cell's noise is made of that noise, which is in
  /// the load, too.
  bool IsNoise(V variable, const Spread& spread) const {
    if (variable != V::kPortForce && variable != V::kLoad) return false;
    return spread.Range() < kForceDeviations * set_.noise.force_N;
  }

  void AddScalar(V variable) {
    const Spread spread = SpreadOf(states_, variable);
    if (!spread.Varies() || IsNoise(variable, spread)) return;
    const double middle = 0.5 * (spread.Low() + spread.High()), range = spread.Range();
    Add(S::kLinear, variable, {middle});
    Add(S::kQuadratic, variable, {middle});
    if (variable != V::kTime)  // that tells nothing of another time
      Add(S::kSmooth, variable, {spread.Low(), spread.High()});
    const double within = variable == V::kTime ? 2.0 * set_.period_s : 0.03 * range;
    for (int i = 1; i < kThresholds; ++i)
      Add(S::kStep, variable, {spread.At(double(i) / kThresholds), within});
    for (int i = 2; i < kThresholds; i += 2) {
      Add(S::kBeyond, variable, {spread.At(double(i) / kThresholds)});
      Add(S::kBelow, variable, {spread.At(double(i) / kThresholds)});
    }
    for (const double part : {0.04, 0.08, 0.15, 0.3, 0.6, 1.2}) {
      Add(S::kExponential, variable, {part * range, variable == V::kTime ? 0.0 : spread.Low()});
      if (variable == V::kSlidingVelocity) Add(S::kTanh, variable, {0.3 * part * range});
      if (variable == V::kLoad || variable == V::kWristSpeed)
        Add(S::kTanh, variable, {part * range});
    }
    if (variable == V::kTime) {
      for (int i = 1; i < kThresholds; ++i)
        for (const double part : {0.02, 0.05, 0.1, 0.2, 0.4})
          Add(S::kAfter, variable, {part * range, spread.At(double(i) / kThresholds)});
      const double fastest_hz = IsStamp(target_) ? kFastestStamp_hz : kFastest_hz;
      AddWaves(variable, range, std::min(fastest_hz, 0.49 / std::max(1e-6, set_.period_s)));
    }
    if (variable == V::kInsertionDepth) AddWaves(variable, range, 1.0 / kShortest_m);
    const bool has_past = variable == V::kInsertionDepth || variable == V::kLoad;
    if (has_past && set_.resolved_in_time) AddMemory(variable);
  }

  /// From one and a half waves over the range on.
  void AddWaves(V variable, double range, double highest) {
    if (!(range > 0.0)) return;
    double step = 0.25 / range;
    const double lowest = 1.5 / range;
    step = std::max(step, (highest - lowest) / double(kMostWaves));
    for (double f = lowest; f < highest; f += step) Add(S::kPeriodic, variable, {f});
  }

  void AddMemory(V variable) {
    const double range = variable == V::kPosition || variable == V::kOwnValue
                             ? LargestRange(states_, variable, inputs_, false)
                             : SpreadOf(states_, variable).Range();
    if (!(range > 0.0)) return;
    for (const double part : {0.002, 0.006, 0.015, 0.03, 0.06, 0.12, 0.25}) {
      Add(S::kPlay, variable, {part * range});
      Add(S::kSmoothPlay, variable, {part * range});
    }
    for (const double time_s : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4})
      Add(S::kRelaxing, variable, {time_s});
  }

  void AddVectors() {
    Add(S::kLinear, V::kPosition, {});
    Add(S::kLinear, V::kOrientation, {});
    if (!IsOfVision() || !set_.has_camera) return;
    for (const S shape : {S::kLinear, S::kQuadratic, S::kRadial}) Add(shape, V::kImagePosition, {});
  }

  void AddOwnValue() {
    const double size = LargestRange(states_, V::kOwnValue, inputs_, true);
    const double range = LargestRange(states_, V::kOwnValue, inputs_, false);
    if (!(size > 0.0) || !(range > 0.0)) return;
    Add(S::kLinear, V::kOwnValue, {0.0});
    Add(S::kQuadratic, V::kOwnValue, {0.0});
    if (target_ == TermTarget::kStrain || target_ == TermTarget::kLoad) {
      for (int i = 1; i < 20; ++i) Add(S::kBand, V::kOwnValue, {0.05 * i * size});
      for (const double part : {0.1, 0.2, 0.4, 0.8}) Add(S::kTanh, V::kOwnValue, {part * size});
    }
    if (target_ == TermTarget::kWristPosition) AddWaves(V::kOwnValue, range, 1.0 / kShortest_m);
    if (set_.resolved_in_time) AddMemory(V::kOwnValue);
  }

  /// Planes of normals all over the sphere, at quantiles of the places along each.
  void AddPlanes() {
    constexpr int kNormals = 48, kPlanes = 10;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int n = 0; n < kNormals; ++n) {  // Fibonacci's sphere
      const double z = 1.0 - 2.0 * (n + 0.5) / kNormals, r = std::sqrt(1.0 - z * z);
      const Eigen::Vector3d normal(r * std::cos(golden * n), r * std::sin(golden * n), z);
      Spread along;
      for (const TermState& state : states_) along.sorted.push_back(normal.dot(state.position));
      std::sort(along.sorted.begin(), along.sorted.end());
      for (int i = 1; i < kPlanes; ++i)
        Add(S::kPastPlane, V::kPosition,
            {normal[0], normal[1], normal[2], along.At(double(i) / kPlanes)});
    }
  }

  /// A grid of places about the motion, as far out as the motion is large.
  void AddPlaces() {
    constexpr int kPlaces = 6;
    Eigen::Vector3d low, high;
    for (int i = 0; i < 3; ++i) {
      const Spread spread = SpreadOf(states_, V::kPosition, i);
      low[i] = spread.Low();
      high[i] = spread.High();
    }
    const double margin = std::max(0.08, (high - low).maxCoeff());
    for (int x = 0; x < kPlaces; ++x)
      for (int y = 0; y < kPlaces; ++y)
        for (int z = 0; z < kPlaces; ++z) {
          Eigen::Vector3d place;
          const int at[3] = {x, y, z};
          for (int i = 0; i < 3; ++i)
            place[i] = low[i] - margin +
                       (high[i] - low[i] + 2.0 * margin) * (at[i] + 0.5) / double(kPlaces);
          for (const double power : {1.0, 2.0, 3.0})
            Add(S::kInversePower, V::kPosition, {place[0], place[1], place[2], power});
        }
  }

  TermTarget target_;
  const std::vector<TermState>& states_;
  const SampleSet& set_;
  int inputs_;
  std::vector<Term> terms_;
};

}  // namespace

std::vector<TermTarget> TargetsOf(const SampleSet& set) {
  std::vector<TermTarget> targets;
  const auto add = [&](TermTarget target, bool there) {
    if (there) targets.push_back(target);
  };
  add(TermTarget::kEmPosition, set.has_em);
  add(TermTarget::kEmOrientation, set.has_em);
  add(TermTarget::kStrain, set.has_strain);
  add(TermTarget::kVisionPosition, set.has_tip);
  add(TermTarget::kVisionDirection, set.has_tip_direction);
  add(TermTarget::kWristOrientation, set.has_wrist_direction);
  add(TermTarget::kWristPosition, true);
  add(TermTarget::kLoad, set.has_load);
  add(TermTarget::kPort, true);
  add(TermTarget::kStiffness, true);
  add(TermTarget::kFriction, true);
  add(TermTarget::kShaftLoad, true);
  add(TermTarget::kCurvature, true);
  add(TermTarget::kEmTime, set.has_em && set.resolved_in_time);
  add(TermTarget::kVisionTime, set.has_tip && set.resolved_in_time);
  return targets;
}

std::vector<Term> Library(TermTarget target, const std::vector<TermState>& states,
                          const SampleSet& set) {
  return Grid(target, states, set).Make();
}

bool IsScale(const Term& term, std::size_t i) {
  switch (term.shape) {
    case S::kBand:
    case S::kTanh:
    case S::kRelaxing:
    case S::kPlay:
    case S::kSmoothPlay:
    case S::kExponential:
    case S::kAfter:
      return i == 0;
    default:
      return false;
  }
}

double StepOf(const Term& term, std::size_t i, const std::vector<TermState>& states) {
  if (IsScale(term, i)) return 0.25;
  if (term.shape == S::kInversePower) return i < 3 ? 0.02 : 0.0;
  if (term.shape == S::kPastPlane) return i < 3 ? 0.1 : 0.004;
  const double range = SpreadOf(states, term.variable).Range();
  if (term.shape == S::kPeriodic) return 0.12 / range;
  const bool threshold =
      (i == 0 && (term.shape == S::kStep || term.shape == S::kBeyond || term.shape == S::kBelow)) ||
      (i == 1 && term.shape == S::kAfter);
  return threshold ? 0.5 * range / kThresholds : 0.0;
}

}  // namespace flextip::diagnosis
