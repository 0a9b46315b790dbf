#include <algorithm>
#include <cmath>

#include "control/angle_search.h"

namespace flextip {
namespace {

/// Where the two ends' own curves, which bound the least eigenvalue from above, cross.
double Crossing(const PencilPoint& low, const PencilPoint& high) {
  const double low_peak = low.PeakX(), high_peak = high.PeakX();
  return std::sqrt((high.cosine * low_peak - low.cosine * high_peak) /
                   (low.cosine / high_peak - high.cosine / low_peak));
}

/// Two eigenvectors of a (nearly) double eigenvalue: the direction in their plane that is balanced,
/// where the extreme is when neither is.
void OfferMixtures(const AnglePencil& pencil, const PencilPoint& low, const PencilPoint& high,
                   AngleCandidate& best) {
  const double x = std::sqrt(low.x * high.x);
  const double a = pencil.Balance(x, low.y, low.y), b = pencil.Balance(x, low.y, high.y),
               c = pencil.Balance(x, high.y, high.y);
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0) || c == 0.0) return;
  for (const double sign : {-1.0, 1.0}) {
    const double t = (-b + sign * std::sqrt(discriminant)) / c;
    const Eigen::Vector3d y = low.y + t * high.y;
    const double size = y.norm();
    if (size > 0.0 && std::isfinite(size)) best.Offer(pencil, x, y / size);
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

}  // namespace

void AngleCandidate::Offer(const AnglePencil& pencil, double at_x,
                           const Eigen::Vector3d& at_y) noexcept {
  const double its_angle = pencil.Angle(at_x, at_y);
  if (its_angle > angle) *this = {at_x, at_y, its_angle};
}

// Closes in on the balanced x: false position with halving (Illinois) and the crossing of the ends'
// curves by turns.
AngleCandidate SearchAcute(const AnglePencil& pencil, PencilPoint low, PencilPoint high) noexcept {
  constexpr int kMaxSteps = 60, kMixFrom = 8;
  AngleCandidate best;
  double low_offset = low.Offset(), high_offset = high.Offset();
  int last_side = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double width = std::log(high.x / low.x);
    if (!(width > 4e-16) || IsClosed(low) || IsClosed(high)) break;
    if (step >= kMixFrom) {
      OfferMixtures(pencil, low, high, best);
      if (Bound(low, high) <= best.angle + kTolerance) break;
    }
    double x = step % 3 == 2 ? Crossing(low, high)
                             : low.x * std::exp(width * low_offset / (low_offset - high_offset));
    if (!(x > low.x && x < high.x)) x = std::sqrt(low.x * high.x);
    const PencilPoint point = pencil.Evaluate(x);
    const int side = point.balance > 0.0 ? -1 : 1;
    (side < 0 ? low : high) = point;
    (side < 0 ? low_offset : high_offset) = point.Offset();
    if (side == last_side) (side < 0 ? high_offset : low_offset) *= 0.5;
    last_side = side;
  }
  if (!IsClosed(low) && !IsClosed(high)) OfferMixtures(pencil, low, high, best);
  best.Offer(pencil, low.x, low.y);
  best.Offer(pencil, high.x, high.y);
  return best;
}

}  // namespace flextip
