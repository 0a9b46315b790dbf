// phi_max in three dimensions: a search along the line of `angle_pencil.h`.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "control/angle_level.h"
#include "control/angle_pencil.h"
#include "control/motion_error.h"

namespace flextip {
namespace {

/// A direction in the pencil's form and its angle.
struct Candidate {
  double x = 1.0;
  Eigen::Vector3d y = Eigen::Vector3d::UnitX();
  double angle = -1.0;  // rad
};

void Offer(const AnglePencil& pencil, double x, const Eigen::Vector3d& y, Candidate& best) {
  const double angle = pencil.Angle(x, y);
  if (angle > best.angle) best = {x, y, angle};
}

// ---- up to 90 degrees: K's least eigenvalue has a single maximum over x, its balance one root

/// How far in log x a point's own best x is.
double Offset(const PencilPoint& point) { return std::atanh(point.balance); }

/// Where the two ends' own curves, which bound the least eigenvalue from above, cross.
double Crossing(const PencilPoint& low, const PencilPoint& high) {
  const double low_peak = low.PeakX(), high_peak = high.PeakX();
  return std::sqrt((high.cosine * low_peak - low.cosine * high_peak) /
                   (low.cosine / high_peak - high.cosine / low_peak));
}

/// Two eigenvectors of a (nearly) double eigenvalue: the direction in their plane that is balanced,
/// where the extreme is when neither is.
void OfferMixtures(const AnglePencil& pencil, const PencilPoint& low, const PencilPoint& high,
                   Candidate& best) {
  const double x = std::sqrt(low.x * high.x);
  const double a = pencil.Balance(x, low.y, low.y), b = pencil.Balance(x, low.y, high.y),
               c = pencil.Balance(x, high.y, high.y);
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0) || c == 0.0) return;
  for (const double sign : {-1.0, 1.0}) {
    const double t = (-b + sign * std::sqrt(discriminant)) / c;
    const Eigen::Vector3d y = low.y + t * high.y;
    const double size = y.norm();
    if (size > 0.0 && std::isfinite(size)) Offer(pencil, x, y / size, best);
  }
}

constexpr double kTolerance = 1e-13;  // rad

/// No direction has an angle past that of the larger least eigenvalue (rad).
double Bound(const PencilPoint& low, const PencilPoint& high) {
  const double missing = std::min(low.missing, high.missing);
  return 2.0 * std::asin(std::sqrt(std::min(0.5 * missing, 1.0)));
}

/// Its own angle is within the tolerance of the bound that it is.
bool IsClosed(const PencilPoint& point) {
  return point.balance * point.balance <= kTolerance * std::sqrt(std::max(point.missing, 0.0));
}

/// Closes in on the balanced x between `low` (balance > 0) and `high` (balance < 0): false position
/// with halving (Illinois) and the crossing of the ends' curves by turns.
Candidate SearchAcute(const AnglePencil& pencil, PencilPoint low, PencilPoint high) {
  constexpr int kMaxSteps = 60, kMixFrom = 8;
  Candidate best;
  double low_offset = Offset(low), high_offset = Offset(high);
  int last_side = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double width = std::log(high.x / low.x);
    if (!(width > 4e-16) || IsClosed(low) || IsClosed(high)) break;
    if (step >= kMixFrom) {
      OfferMixtures(pencil, low, high, best);
      if (Bound(low, high) <= best.angle + kTolerance) break;
    }
    double x = step % 3 == 2
                   ? Crossing(low, high)
                   : low.x * std::exp(width * low_offset / (low_offset - high_offset));
    if (!(x > low.x && x < high.x)) x = std::sqrt(low.x * high.x);
    const PencilPoint point = pencil.Evaluate(x);
    const int side = point.balance > 0.0 ? -1 : 1;
    (side < 0 ? low : high) = point;
    (side < 0 ? low_offset : high_offset) = Offset(point);
    if (side == last_side) (side < 0 ? high_offset : low_offset) *= 0.5;
    last_side = side;
  }
  if (!IsClosed(low) && !IsClosed(high)) OfferMixtures(pencil, low, high, best);
  Offer(pencil, low.x, low.y, best);
  Offer(pencil, high.x, high.y, best);
  return best;
}

// ---- past 90 degrees: K's least eigenvalue can have several minima over x

constexpr double kProved = 1e-10;     // rad
constexpr double kRounding = 4e-15;  // of a cosine

/// True where `a` is nearer a minimum than `b`; equal cosines are told apart by their balance.
bool IsBetter(const PencilPoint& a, const PencilPoint& b) {
  const double gain = b.cosine - a.cosine;
  return gain > kRounding ||
         (gain > -kRounding && std::abs(a.balance) < std::abs(b.balance));
}

/// What is left to gain, about: near 180 degrees the angle is a cone over the directions, elsewhere
/// it is smooth.
bool IsBalanced(const PencilPoint& point) {
  const double sine2 = (1.0 - point.cosine) * (1.0 + point.cosine);
  const double balance = std::abs(point.balance);
  return balance * balance <= 1e-16 * (std::sqrt(std::max(sine2, 0.0)) + balance);
}

/// Climbs from `best` to a minimum of the least eigenvalue: secant steps on the offset where they
/// stay between the points that are known to be lower, else toward the point's own best x, twice as
/// far each time. Never descends.
PencilPoint Climb(const AnglePencil& pencil, PencilPoint best) {
  constexpr int kMaxSteps = 50;
  double low = std::log(pencil.SmallestX()), high = std::log(pencil.LargestX());
  double at = std::log(best.x), last_at = at, last_offset = 0.0, reach = 1.0;
  for (int step = 0; step < kMaxSteps && !IsBalanced(best); ++step) {
    const double offset = Offset(best);
    (offset > 0.0 ? low : high) = at;
    double next_at = at + reach * offset;
    const double slope = last_at != at ? (offset - last_offset) / (at - last_at) : 0.0;
    if (slope < 0.0) next_at = at - offset / slope;
    if (!(next_at > low && next_at < high)) next_at = 0.5 * (low + high);
    if (next_at == at) break;
    const PencilPoint next = pencil.Evaluate(std::exp(next_at));
    reach *= 2.0;
    if (IsBetter(next, best)) {
      last_at = at;
      last_offset = offset;
      best = next;
      at = next_at;
    } else {
      last_at = next_at;
      last_offset = Offset(next);
      (offset > 0.0 ? high : low) = next_at;
    }
  }
  return best;
}

/// What a look for larger angles found.
enum class Look : std::uint8_t { kNothingLarger, kLarger, kGaveUp };

/// Looks for a direction whose cosine is below `best`'s by more than `slack`. Replaces `best` by
/// one if there is. A curve that peaks at x falls off as 1 / cosh(log x), so that what was seen at
/// one x bounds the peaks near it.
Look FindLarger(const AnglePencil& pencil, double slack, PencilPoint& best) {
  constexpr int kMaxIntervals = 400;
  const double level = -best.cosine + 0.5 * slack;
  if (level >= 1.0) return Look::kNothingLarger;
  const AngleLevel larger(pencil, level);
  const double near = std::sqrt(slack / level);  // in log x: cosh adds half the slack there
  struct Interval {
    double a, b;
  };
  std::array<Interval, 64> stack;
  int size = 0;
  stack[size++] = {pencil.SmallestX(), best.x / (1.0 + near)};
  stack[size++] = {best.x * (1.0 + near), pencil.LargestX()};
  for (int n = 0; size > 0; ++n) {
    if (n == kMaxIntervals) return Look::kGaveUp;
    const Interval now = stack[--size];
    if (!(now.b > now.a) || larger.IsPositive(now.a, now.b)) continue;
    const double middle = std::sqrt(now.a * now.b);
    const bool is_short = now.b < now.a * (1.0 + near);
    if (is_short || larger.Value(middle) <= 0.0) {
      const PencilPoint point = pencil.Evaluate(middle);
      if (-point.cosine > level) {
        best = point;
        return Look::kLarger;
      }
    }
    if (is_short) continue;
    if (size + 2 > static_cast<int>(stack.size())) return Look::kGaveUp;
    stack[size++] = {now.a, middle};
    stack[size++] = {middle, now.b};
  }
  return Look::kNothingLarger;
}

/// Climbs, proves that nothing is larger or climbs from what is. False if it ran out of work.
bool SearchObtuse(const AnglePencil& pencil, const PencilPoint& start, Candidate& best) {
  constexpr int kMaxClimbs = 16;
  PencilPoint point = start;
  for (int climb = 0; climb < kMaxClimbs; ++climb) {
    point = Climb(pencil, point);
    Offer(pencil, point.x, point.y, best);
    if (best.angle >= std::numbers::pi - kProved) return true;
    const double slack = std::max(kProved * std::sin(best.angle), kRounding);
    const Look look = FindLarger(pencil, slack, point);
    if (look != Look::kLarger) return look == Look::kNothingLarger;
  }
  return false;
}

/// False only where J has full rank by the singular values of A and J_hat.
bool MayBeSingular(const Eigen::Vector3d& sigma, const Eigen::Vector3d& sigma_hat) {
  const double condition_hat = sigma_hat.maxCoeff() / sigma_hat.minCoeff();
  return sigma.minCoeff() <= 1e-14 * condition_hat * sigma.maxCoeff();
}

/// Fills in `error` from A's decomposition.
void FindInSpace(const AnglePencil& pencil, AngleError<3>& error) {
  // The sign of K's least eigenvalue is the same at all x, but at some it may be lost in rounding.
  const PencilPoint low = pencil.Evaluate(pencil.SmallestX());
  const PencilPoint high = pencil.Evaluate(pencil.LargestX());
  const PencilPoint middle = pencil.Evaluate(std::sqrt(low.x * high.x));
  PencilPoint start = low;
  for (const PencilPoint& point : {middle, high}) {
    if (point.cosine < start.cosine) start = point;
  }
  Candidate best;
  if (start.cosine < 0.0) {
    if (!SearchObtuse(pencil, start, best)) error.status = MotionErrorStatus::kNotConverged;
  } else {
    best = middle.balance > 0.0 ? SearchAcute(pencil, middle, high)
                                : SearchAcute(pencil, low, middle);
  }
  error.phi_max_rad = best.angle;
  error.p_phi = pencil.Direction(best.x, best.y);
}

}  // namespace

AngleError<3> FindLargestAngle(const Eigen::Matrix3d& J, const Eigen::Matrix3d& J_hat) noexcept {
  AngleError<3> error;
  const double size = J.cwiseAbs().maxCoeff(), size_hat = J_hat.cwiseAbs().maxCoeff();
  if (!J.allFinite() || !J_hat.allFinite()) return error;
  error.status = MotionErrorStatus::kSingularEstimate;
  if (size_hat == 0.0) return error;
  const SmallSvd svd_hat = DecomposeSmall(J_hat / size_hat);
  if (MissingRank(svd_hat.sigma) > 0) return error;
  error.status = MotionErrorStatus::kSingularTruth;
  if (size == 0.0) return error;
  const Eigen::Matrix3d J_scaled = J / size;
  // A = J V_hat Sigma_hat^-1 U_hat^T, but for the factor U_hat^T, which goes to the right vectors.
  SmallSvd svd = DecomposeSmall(J_scaled * svd_hat.V * svd_hat.sigma.cwiseInverse().asDiagonal());
  svd.V = svd_hat.U * svd.V;
  const int missing_rank = MayBeSingular(svd.sigma, svd_hat.sigma)
                               ? MissingRank(DecomposeSmall(J_scaled).sigma)
                               : 0;
  if (missing_rank == 0) error.status = MotionErrorStatus::kOk;
  FindInSpace(AnglePencil(svd, missing_rank), error);
  return error;
}

}  // namespace flextip
