#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "control/angle_level.h"
#include "control/angle_search.h"

namespace flextip {
namespace {

constexpr double kProved = 1e-10;        // rad
constexpr double kProvedCosine = 2e-14;  // and not to less than this, that is for the last 1e-4 rad
constexpr double kRounding = 4e-15;      // of a cosine

/// True where the climb goes on from `next`: it is lower, or as low to rounding and either nearer
/// to balanced or further along a flat stretch in the direction of `offset`.
bool GoesOn(const PencilPoint& next, const PencilPoint& best, double offset) {
  const double gain = best.cosine - next.cosine;
  if (std::abs(gain) > kRounding) return gain > 0.0;
  const bool is_onward = (next.x > best.x) == (offset > 0.0) && offset * next.balance > 0.0;
  return is_onward || std::abs(next.balance) < std::abs(best.balance);
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
    const double offset = best.Offset();
    (offset > 0.0 ? low : high) = at;
    double next_at = at + reach * offset;
    const double slope = last_at != at ? (offset - last_offset) / (at - last_at) : 0.0;
    if (slope < 0.0) next_at = at - offset / slope;
    if (!(next_at > low && next_at < high)) next_at = 0.5 * (low + high);
    if (next_at == at) break;
    const PencilPoint next = pencil.Evaluate(std::exp(next_at));
    reach *= 2.0;
    if (GoesOn(next, best, offset)) {
      last_at = at;
      last_offset = offset;
      best = next;
      at = next_at;
    } else {
      last_at = next_at;
      last_offset = next.Offset();
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

}  // namespace

bool SearchObtuse(const AnglePencil& pencil, const PencilPoint& start,
                  AngleCandidate& best) noexcept {
  constexpr int kMaxClimbs = 16;
  PencilPoint point = start;
  for (int climb = 0; climb < kMaxClimbs; ++climb) {
    point = Climb(pencil, point);
    best.Offer(pencil, point.x, point.y);
    if (best.angle >= std::numbers::pi - kProved) return true;
    const double slack = std::max(kProved * std::sin(best.angle), kProvedCosine);
    const Look look = FindLarger(pencil, slack, point);
    if (look != Look::kLarger) return look == Look::kNothingLarger;
  }
  return false;
}

}  // namespace flextip
