#include "vision/photometric/tone_curve.h"

#include <cmath>

namespace flextip {

constexpr double kDarkGrey = 3.0;

ToneCurve::ToneCurve(double gamma)
    : gamma_(gamma),
      dark_light_(static_cast<float>(std::pow(kDarkGrey / 255, gamma))),
      dark_slope_(static_cast<float>(kDarkGrey / gamma / dark_light_)),
      dark_grey_(static_cast<float>(kDarkGrey)) {
  for (int i = 0; i < static_cast<int>(values_.size()); ++i) {
    const double root = static_cast<double>(i) / kSteps;
    const double light = std::max<double>(root * root, 0.25 * dark_light_);
    const double grey = 255 * std::pow(light, 1 / gamma);
    values_[i] = {static_cast<float>(grey), static_cast<float>(grey / (gamma * light)),
                  static_cast<float>(-grey * std::log(light) / (gamma * gamma))};
  }
}

double ToneCurve::Light(double grey) const { return std::pow(std::max(grey, 0.0) / 255, gamma_); }

}  // namespace flextip
