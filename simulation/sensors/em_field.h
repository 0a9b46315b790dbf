// How metal near an electromagnetic tracker bends its field.
#pragma once

#include <Eigen/Dense>

namespace flextip::simulation {

/// The bias of a tracked position, p_measured = p + Bias(p): `gradient` (p - centre) and, of second
/// order and higher in p - centre, the rest of the field of a dipole 0.5 m from the centre (value
/// and gradient at the centre taken off, so that the linear part is `gradient` exactly). The rest
/// is scaled so that its RMS over the sphere of 0.1 m around the centre is `curvature` times the
/// linear part's. The dipole lies where the gradient is steepest.
class EmField {
 public:
  EmField() : EmField(Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero(), 0.0) {}
  EmField(const Eigen::Matrix3d& gradient, const Eigen::Vector3d& p_centre, double curvature);

  Eigen::Vector3d Bias(const Eigen::Vector3d& p) const;

 private:
  Eigen::Vector3d Rest(const Eigen::Vector3d& offset) const;  ///< unscaled

  Eigen::Matrix3d gradient_;
  Eigen::Vector3d p_centre_;
  Eigen::Vector3d dipole_ = Eigen::Vector3d::UnitX();  // from the centre
  Eigen::Vector3d moment_ = Eigen::Vector3d::UnitX();  // unit
  double rest_scale_ = 0.0;
};

}  // namespace flextip::simulation
