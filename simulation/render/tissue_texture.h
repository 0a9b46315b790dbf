// Living tissue, wet: patches of colour, vessels, gentle hills, and highlights where it is wet.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "core/pose.h"
#include "simulation/render/laparoscope.h"
#include "simulation/render/light.h"

namespace flextip::simulation {

/// The tissue as the camera sees it. All randomness comes from the seed.
class TissueTexture {
 public:
  TissueTexture(const TissueOptions& options, const Pose& T_RC, std::uint64_t seed);

  /// The light (blue, green, red) from where the ray (camera frame, from its centre) meets the
  /// tissue; black where it does not meet it. The depth x = depth * ray goes to `depth`, infinity
  /// where there is none.
  Eigen::Vector3f Radiance(const Eigen::Vector3d& ray, const render::Light& light,
                           double& depth) const;

 private:
  Eigen::Vector3d Relief(double u, double v) const;  // (height, d/du, d/dv) in m, m/m
  Eigen::Vector3f Albedo(double u, double v) const;
  double Vessels(double u, double v) const;  // 0 none to 1

  TissueOptions options_;
  std::uint32_t seed_;
  Eigen::Vector3d point_C_, e_u_, e_v_, normal_C_;
};

}  // namespace flextip::simulation
