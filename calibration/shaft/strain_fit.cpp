#include "calibration/shaft/strain_fit.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr int kMaxIterations = 50;
constexpr double kWidePrior = 30.0;  // of the typical gain and reading
// Of kGageUnknowns.
using Information = Eigen::MatrixXd;
using UnknownVector = Eigen::VectorXd;

/// What is typical: readings by channel, and moments.
struct Scales {
  Eigen::Vector4d reading = Eigen::Vector4d::Ones();
  double moment = 1.0;
};

Scales ScalesOf(const std::vector<GageSample>& samples) {
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), squares = mean;
  double moments = 0, n = 0;
  for (const GageSample& s : samples) {
    mean += s.readings;
    ++n;
  }
  mean /= std::max(n, 1.0);
  for (const GageSample& s : samples) {
    squares += (s.readings - mean).cwiseAbs2();
    moments = std::max(moments, s.m_Nm.cwiseAbs().maxCoeff());
  }
  Scales scales;
  scales.reading = (squares / std::max(n, 1.0)).cwiseSqrt() + 1e-6 * mean.cwiseAbs();
  const double most = scales.reading.maxCoeff();
  scales.reading = scales.reading.cwiseMax(most > 0 ? 1e-6 * most : 1.0);
  scales.moment = moments > 0 ? moments : 1.0;
  return scales;
}

/// Information of the priors; a gain that is held at zero has an infinite one in effect.
UnknownVector PriorInformation(const Scales& scales, const Eigen::Vector4d& mean_reading,
                               const GageFitOptions& options) {
  UnknownVector information(kGageUnknowns);
  for (int row = 0; row < 4; ++row) {
    const double gain = kWidePrior * scales.reading[row] / scales.moment;
    for (int column = 0; column < 4; ++column) {
      const bool held = options.stations_apart && row / 2 != column / 2;
      information[4 * row + column] = std::pow(held ? 1e-9 * gain : gain, -2);
    }
    const double offset = kWidePrior * (scales.reading[row] + std::abs(mean_reading[row]));
    information[kGageOffset + row] = 1 / (offset * offset);
  }
  information.tail<3>().setConstant(std::pow(std::max(options.port_noise_m, 1e-9), -2));
  return information;
}

UnknownVector Packed(const GageFit& fit) {
  UnknownVector x(kGageUnknowns);
  for (int row = 0; row < 4; ++row) x.segment<4>(4 * row) = fit.gains.row(row).transpose();
  x.segment<4>(kGageOffset) = fit.offset;
  x.tail<3>() = fit.port_shift_m;
  return x;
}
void Unpack(const UnknownVector& x, GageFit& fit) {
  for (int row = 0; row < 4; ++row) fit.gains.row(row) = x.segment<4>(4 * row).transpose();
  fit.offset = x.segment<4>(kGageOffset);
  fit.port_shift_m = x.tail<3>();
}

}  // namespace

Eigen::Matrix<double, 4, kGageUnknowns> GageRows(const GageFit& fit, const Eigen::Vector4d& m_Nm,
                                                 const Eigen::Matrix<double, 4, 3>& m_by_port) {
  Eigen::Matrix<double, 4, kGageUnknowns> J = Eigen::Matrix<double, 4, kGageUnknowns>::Zero();
  for (int row = 0; row < 4; ++row) J.block<1, 4>(row, 4 * row) = m_Nm.transpose();
  J.middleCols<4>(kGageOffset).setIdentity();
  J.rightCols<3>() = fit.gains * m_by_port;
  return J;
}

GageResidual ResidualOf(const GageSample& s, const GageFit& fit) {
  const Eigen::Vector4d m = s.m_Nm + s.m_by_port * fit.port_shift_m;
  GageResidual residual;
  residual.readings = s.readings - fit.offset - fit.gains * m;
  residual.covariance = fit.gains * s.m_covariance * fit.gains.transpose();
  residual.covariance.diagonal() += s.reading_sd.cwiseAbs2();
  return residual;
}

GageFit FitGages(const std::vector<GageSample>& samples, const GageFitOptions& options) {
  GageFit fit;
  if (samples.empty()) return fit;
  const Scales scales = ScalesOf(samples);
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  for (const GageSample& s : samples) mean += s.readings / static_cast<double>(samples.size());
  const UnknownVector prior = PriorInformation(scales, mean, options);
  const UnknownVector unit = prior.cwiseSqrt().cwiseInverse();  // the equations' columns
  for (int i = 0; i < kMaxIterations && !fit.converged; ++i) {
    UnknownVector gradient = -prior.cwiseProduct(Packed(fit));
    Information N = prior.asDiagonal().toDenseMatrix();
    for (const GageSample& s : samples) {
      if (s.weight == 0) continue;
      const GageResidual r = ResidualOf(s, fit);
      const Ldlt S(r.covariance);
      // The moments as they most likely were, by both sides.
      const Eigen::Vector4d m = s.m_Nm + s.m_by_port * fit.port_shift_m +
                                s.m_covariance * fit.gains.transpose() * S.Solve(r.readings);
      const Eigen::MatrixXd J = GageRows(fit, m, s.m_by_port);
      N += s.weight * J.transpose() * S.Solve(J);
      gradient += s.weight * J.transpose() * S.Solve(r.readings);
    }
    const Information scaled = unit.asDiagonal() * N * unit.asDiagonal();
    const Ldlt solver(scaled);
    const UnknownVector dx = unit.cwiseProduct(solver.Solve(unit.cwiseProduct(gradient)));
    Unpack(Packed(fit) + dx, fit);
    fit.covariance = unit.asDiagonal() * solver.Inverse() * unit.asDiagonal();
    fit.converged = dx.cwiseAbs2().dot(N.diagonal()) < 1e-10 * kGageUnknowns;
  }
  return fit;
}

}  // namespace flextip
