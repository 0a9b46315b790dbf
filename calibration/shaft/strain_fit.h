// Gages fitted to known moments, both with errors: readings = gages x moments + offset. Private to
// calibration.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "core/linear_algebra.h"

namespace flextip {

/// One hold: the gages' readings, and the moments by the load.
struct GageSample {
  Eigen::Vector4d readings = Eigen::Vector4d::Zero(), m_Nm = Eigen::Vector4d::Zero();
  Eigen::Vector4d reading_sd = Eigen::Vector4d::Ones();    ///< of `readings`
  Eigen::Matrix4d m_covariance = Eigen::Matrix4d::Zero();  ///< of its own, without the port's
  Eigen::Matrix<double, 4, 3> m_by_port = Eigen::Matrix<double, 4, 3>::Zero();
  double weight = 1.0;  ///< 0: left out
};

/// 16 gains row by row, 4 offsets, 3 of the port's place.
inline constexpr int kGains = 16, kGageOffset = 16, kGagePort = 20, kGageUnknowns = 23;

struct GageFit {
  Eigen::Matrix4d gains = Eigen::Matrix4d::Zero();  ///< readings per Nm
  Eigen::Vector4d offset = Eigen::Vector4d::Zero();
  Eigen::Vector3d port_shift_m = Eigen::Vector3d::Zero();
  Eigen::MatrixXd covariance;  ///< kGageUnknowns
  bool converged = false;
};

struct GageFitOptions {
  double port_noise_m = 3e-4;
  bool stations_apart = false;  ///< the gages of one station do not feel the other's moment
};

/// Fits by maximum likelihood with the true moments as unknowns (errors in both variables; Fuller,
/// Measurement Error Models, 1987, ch. 3). Gauss-Newton works on the residuals after their
/// elimination. Parameters that the samples do not show stay at zero, with a standard deviation of
/// 30 times the typical value.
GageFit FitGages(const std::vector<GageSample>& samples, const GageFitOptions& options);

/// The residual of a sample, and its expected covariance.
struct GageResidual {
  Eigen::Vector4d readings;
  Eigen::Matrix4d covariance;
  double Chi2() const { return MahalanobisSquared(readings, covariance); }
};
GageResidual ResidualOf(const GageSample& sample, const GageFit& fit);

/// Returns the rows that a sample adds to the equations of the fit: derivative of the readings.
Eigen::Matrix<double, 4, kGageUnknowns> GageRows(const GageFit& fit, const Eigen::Vector4d& m_Nm,
                                                 const Eigen::Matrix<double, 4, 3>& m_by_port);

}  // namespace flextip
