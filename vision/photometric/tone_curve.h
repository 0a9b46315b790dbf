// From linear light to a camera's 8-bit grey value and back.
#pragma once

#include <array>
#include <cmath>

namespace flextip {

/// grey = 255 light^(1/gamma), clipped at light 1; light 0 to 1 between no signal and full.
class ToneCurve {
 public:
  explicit ToneCurve(double gamma = 2.2);

  double Gamma() const { return gamma_; }
  /// The straight part: from `DarkLight` down, where the grey value is `DarkGrey`.
  float DarkLight() const { return dark_light_; }
  float DarkGrey() const { return dark_grey_; }
  float DarkSlope() const { return dark_slope_; }

  struct Value {
    float grey, by_light, by_gamma;  ///< the grey value and its derivatives
  };
  /// Returns the grey value of `light`. Derivatives are zero where the curve is clipped above.
  /// Below a grey value of 3 the curve goes on straight.
  Value At(float light) const {
    if (light >= 1) return {255, 0, 0};
    if (light <= dark_light_) {
      return {dark_grey_ + dark_slope_ * (light - dark_light_), dark_slope_, 0};
    }
    const float at = std::sqrt(light) * kSteps;
    const int i = static_cast<int>(at);
    const float t = at - static_cast<float>(i);
    const Value &a = values_[i], &b = values_[i + 1];
    return {a.grey + t * (b.grey - a.grey), a.by_light + t * (b.by_light - a.by_light),
            a.by_gamma + t * (b.by_gamma - a.by_gamma)};
  }

  /// Returns the light that gives `grey` (0 to 255).
  double Light(double grey) const;

 private:
  static constexpr int kSteps = 512;
  double gamma_;
  float dark_light_, dark_slope_, dark_grey_;
  std::array<Value, kSteps + 2> values_;  // by steps of the light's root
};

}  // namespace flextip
