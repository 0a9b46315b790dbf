// One axis of a drawn figure: from values to px, and its ticks.
#pragma once

#include <string>
#include <vector>

namespace flextip::report {

struct Tick {
  double value = 0.0;
  std::string text;
};

class Axis {
 public:
  /// Spans `low` to `high`; no length or not finite: a stretch around the value, or 0 to 1. On a
  /// logarithmic axis values must be positive.
  Axis(double low, double high, bool log = false);

  /// Returns where `value` lies: 0 at the low end, 1 at the high end.
  double Share(double value) const;
  /// Returns round values inside the axis, about `count` of them; powers of ten where logarithmic.
  std::vector<Tick> Ticks(int count) const;
  /// Makes the axis `factor` times as long around its middle. Not for logarithmic axes.
  void Widen(double factor);
  double Low() const { return low_; }
  double High() const { return high_; }

 private:
  double low_, high_;
  bool log_;
};

}  // namespace flextip::report
