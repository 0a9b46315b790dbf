#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/shaft/next_load.h"
#include "calibration/shaft/strain_calibration.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kWorthwhile = 0.03;  // of the moments' uncertainty

/// How well moments of the recording's size are read, as a share of the gains (root of the trace).
double Uncertainty(const Eigen::MatrixXd& information, const Eigen::VectorXd& unit) {
  const Eigen::MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::MatrixXd C = Ldlt(scaled).Inverse();
  return std::sqrt(C.diagonal().head(kGagePort).sum() / kGagePort);
}

}  // namespace

std::string NextStrainLoad(const std::vector<StrainHoldResult>& holds, const GageFit& fit,
                           const Eigen::Vector4d& reading_sd, const Eigen::Vector3d& p_RP,
                           MomentModel& model) {
  if (fit.covariance.size() == 0) return "";
  double moment = 1e-12;
  for (const auto& h : holds) moment = std::max(moment, h.m_stated_Nm.cwiseAbs().maxCoeff());
  // Gains count as what they make of a moment of the recording's size, beside the typical gain.
  Eigen::VectorXd unit(kGageUnknowns);
  const double gain = std::max(fit.gains.cwiseAbs().maxCoeff(), 1e-300);
  unit.head(kGains).setConstant(gain);
  unit.segment<4>(kGageOffset).setConstant(gain * moment);
  unit.tail<3>().setConstant(1e-3);
  const Eigen::MatrixXd scaled_C =
      unit.cwiseInverse().asDiagonal() * fit.covariance * unit.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd information = unit.cwiseInverse().asDiagonal() * Ldlt(scaled_C).Inverse() *
                                      unit.cwiseInverse().asDiagonal();
  const double now = Uncertainty(information, unit);
  double best = now;
  std::string words;
  std::vector<PlacedHold> placed;
  for (const auto& h : holds) {
    if (h.used) placed.push_back({h.hold, h.s_port_m});
  }
  for (const NextLoad& candidate : NextLoads(placed, p_RP)) {
    const auto stated = model.At(candidate.hold);
    if (!stated) continue;
    const Eigen::MatrixXd J = GageRows(fit, stated->m_Nm, stated->by_port);
    Eigen::Matrix4d S = fit.gains * stated->Covariance(candidate.hold) * fit.gains.transpose();
    S.diagonal() += reading_sd.cwiseAbs2();
    const double then = Uncertainty(information + J.transpose() * Ldlt(S).Solve(J), unit);
    if (!(then < best)) continue;
    best = then;
    words = candidate.words;
  }
  if (!(best <= (1 - kWorthwhile) * now)) return "";  // nor where nothing is known yet
  return fmt::format("{} (the gains' uncertainty falls to {:.0f} %)", words, 100 * best / now);
}

}  // namespace flextip
