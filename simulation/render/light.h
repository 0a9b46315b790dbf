// The scope's light and how surfaces throw it back. Everything is in the camera's frame.
#pragma once

#include <Eigen/Dense>

namespace flextip::simulation::render {

struct Material {
  Eigen::Vector3f albedo = Eigen::Vector3f::Ones();        ///< blue, green, red
  Eigen::Vector3f albedo_black = Eigen::Vector3f::Zero();  ///< of a tag's black cells
  float gloss_wide = 0, gloss_narrow = 0;                  ///< strength of two highlights
};

/// Light from the camera's centre on a surface, seen from there: the colour is
/// albedo * diffuse + specular.
struct Shade {
  float diffuse = 0, specular = 0;
};

/// A point light at the camera's centre.
struct Light {
  double strength = 1;    ///< signal times squared distance (m^2) of a white surface on the axis
  double vignetting = 0;  ///< power of the cosine of the angle off the axis

  /// The signal of a white matt surface at `x` that faces the light.
  double Irradiance(const Eigen::Vector3d& x) const;
  Shade On(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const Material& m) const;
};

}  // namespace flextip::simulation::render
