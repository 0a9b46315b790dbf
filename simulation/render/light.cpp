#include "simulation/render/light.h"

#include <cmath>

namespace flextip::simulation::render {
namespace {

double Power16(double x) {
  x *= x;
  x *= x;
  x *= x;
  return x * x;
}

}  // namespace

double Light::Irradiance(const Eigen::Vector3d& x) const {
  const double squared = x.squaredNorm();
  const double axis = x.z() / std::sqrt(squared);
  if (axis <= 0) return 0;
  return strength / squared * (vignetting > 0 ? std::pow(axis, vignetting) : 1.0);
}

Shade Light::On(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const Material& m) const {
  // Lambert, and two lobes about the mirror direction, which for a light at the eye is the normal.
  const double facing = std::abs(normal.dot(x)) / x.norm();
  const double light = Irradiance(x);
  Shade shade;
  shade.diffuse = static_cast<float>(light * facing);
  if (m.gloss_wide > 0 || m.gloss_narrow > 0) {
    const double wide = Power16(facing), narrow = Power16(wide);
    shade.specular = static_cast<float>(light * (m.gloss_wide * wide + m.gloss_narrow * narrow));
  }
  return shade;
}

}  // namespace flextip::simulation::render
