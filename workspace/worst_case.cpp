#include "workspace/worst_case.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip {
namespace {

/// A place in the unit box or ball: no more components than there are errors.
template <int N>
using Unit = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, BeliefError<N>::kCount, 1>;

/// The measure as a function of x in the unit box or ball, one component for each error that is
/// bounded away from zero.
template <int N>
class ErrorSet {
 public:
  ErrorSet(const MapSetup<N>& setup, const TrueState<N>& state, const ErrorBounds<N>& bounds,
           Measure measure, double scale)
      : setup_(setup),
        state_(state),
        shape_(bounds.shape),
        measure_(measure),
        nominal_(setup.error.AsVector()),
        half_(scale * bounds.half_width.AsVector()) {
    for (int i = 0; i < BeliefError<N>::kCount; ++i)
      if (half_[i] > 0.0) active_.push_back(i);
    const auto at_nominal = Believe(setup_.truth, setup_.error, state_.theta);
    if (at_nominal) reaches_ = at_nominal->Reaches();
    if (at_nominal) sign_ = at_nominal->J_hat.determinant();
  }

  int Size() const { return int(active_.size()); }
  BeliefError<N> Error(const Unit<N>& x) const {
    typename BeliefError<N>::Vector v = BeliefError<N>::Vector::Zero();
    for (int i = 0; i < Size(); ++i) v[active_[i]] = half_[active_[i]] * x[i];
    return BeliefError<N>::FromVector(v);
  }

  double Value(const Unit<N>& x) const {
    const auto error = BeliefError<N>::FromVector(nominal_ + Error(x).AsVector());
    const auto belief = Believe(setup_.truth, error, state_.theta);
    if (!belief || belief->Reaches() != reaches_ || belief->J_hat.determinant() * sign_ <= 0.0)
      return Hopeless();  // between it and the setup's own error lies a singular Jacobian
    if (measure_ == Measure::kNorm) return FindStepError(state_.J, belief->J_hat, setup_.gain).norm;
    return FindLargestAngle(state_.J, belief->J_hat).phi_max_rad;
  }
  double Hopeless() const {
    return measure_ == Measure::kNorm ? std::numeric_limits<double>::infinity() : std::numbers::pi;
  }

  /// The nearest point of the set, or one near it.
  void Confine(Unit<N>& x) const {
    if (shape_ == BoundShape::kBox) {
      x = x.cwiseMax(-1.0).cwiseMin(1.0);
    } else if (x.norm() > 1.0) {
      x.normalize();
    }
  }

  /// Corners, and the middles of faces; on the ball where they point to.
  std::vector<Unit<N>> Starts() const {
    std::vector<Unit<N>> starts;
    for (unsigned corner = 0; corner < (1U << Size()); ++corner) {
      Unit<N> x(Size());
      for (int i = 0; i < Size(); ++i) x[i] = (corner >> i) & 1U ? 1.0 : -1.0;
      Confine(x);
      starts.push_back(x);
    }
    for (int i = 0; i < 2 * Size(); ++i)
      starts.emplace_back((i % 2 ? 1.0 : -1.0) * Unit<N>::Unit(Size(), i / 2));
    return starts;
  }

 private:
  const MapSetup<N>& setup_;
  const TrueState<N>& state_;
  BoundShape shape_;
  Measure measure_;
  typename BeliefError<N>::Vector nominal_, half_;
  std::vector<int> active_;
  bool reaches_ = true;
  double sign_ = 0.0;
};

template <int N>
struct Found {
  Unit<N> x;
  double value = 0.0;
};

/// Steps along the axes that help, halved when none does.
template <int N>
void Climb(const ErrorSet<N>& set, Found<N>& best) {
  constexpr double kFirst = 0.5, kLast = 1e-5, kWorthwhile = 1e-9;
  // A step's: along a curved bound gains go on for ever.
  constexpr int kFew = 4, kSweepsOfFew = 20, kSweepsOfMany = 6;
  const int sweeps = set.Size() <= kFew ? kSweepsOfFew : kSweepsOfMany;
  for (double step = kFirst; step > kLast; step *= 0.5) {
    bool better = true;
    for (int sweep = 0; better && sweep < sweeps; ++sweep) {
      better = false;
      for (int i = 0; i < 2 * set.Size(); ++i) {
        if (best.value == set.Hopeless()) return;
        Unit<N> x = best.x;
        x[i / 2] += i % 2 ? step : -step;
        set.Confine(x);
        const double value = set.Value(x);
        if (!(value > best.value * (1.0 + kWorthwhile))) continue;
        best = {.x = x, .value = value};
        better = true;
      }
    }
  }
}

}  // namespace

template <int N>
WorstError<N> FindWorst(const MapSetup<N>& setup, const TrueState<N>& state,
                        const ErrorBounds<N>& bounds, Measure measure, double scale) {
  const ErrorSet<N> set(setup, state, bounds, measure, scale);
  std::vector<Found<N>> found;
  for (const auto& x : set.Starts()) found.push_back({.x = x, .value = set.Value(x)});
  constexpr std::size_t kClimbs = 3;
  const std::size_t climbs = std::min(kClimbs, found.size());
  std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(climbs), found.end(),
                    [](const Found<N>& a, const Found<N>& b) { return a.value > b.value; });
  for (std::size_t i = 0; i < climbs; ++i) Climb(set, found[i]);
  const Found<N>& best =
      *std::max_element(found.begin(), found.end(),
                        [](const Found<N>& a, const Found<N>& b) { return a.value < b.value; });
  return {.value = best.value, .error = set.Error(best.x)};
}

template <int N>
std::vector<double> WorstOverMap(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                                 const ErrorBounds<N>& bounds, Measure measure) {
  std::vector<double> worst(map.points.size(), std::numeric_limits<double>::quiet_NaN());
  tbb::parallel_for(std::size_t{0}, map.points.size(), [&](std::size_t i) {
    const auto& state = map.points[i].state;
    if (state) worst[i] = FindWorst(setup, *state, bounds, measure).value;
  });
  return worst;
}

template WorstError<2> FindWorst(const MapSetup<2>&, const TrueState<2>&, const ErrorBounds<2>&,
                                 Measure, double);
template WorstError<3> FindWorst(const MapSetup<3>&, const TrueState<3>&, const ErrorBounds<3>&,
                                 Measure, double);
template std::vector<double> WorstOverMap(const MapSetup<2>&, const WorkspaceMap<2>&,
                                          const ErrorBounds<2>&, Measure);
template std::vector<double> WorstOverMap(const MapSetup<3>&, const WorkspaceMap<3>&,
                                          const ErrorBounds<3>&, Measure);
}  // namespace flextip
