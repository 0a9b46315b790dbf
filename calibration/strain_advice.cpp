#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/strain_calibration.h"

namespace flextip {
namespace {

constexpr double kWorthwhile = 0.03;  // of the moments' uncertainty

/// How well moments of the recording's size are read, as a share of the gains (root of the trace).
double Uncertainty(const Eigen::MatrixXd& information, const Eigen::VectorXd& unit) {
  const Eigen::MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::MatrixXd C =
      scaled.ldlt().solve(Eigen::MatrixXd::Identity(unit.size(), unit.size()));
  return std::sqrt(C.diagonal().head(kGagePort).sum() / kGagePort);
}

struct Candidate {
  LoadHold hold;
  std::string words;
};

/// The wrist where it was with the port nearest to, midway, and furthest along the shaft, and each
/// pushed on by a tenth; the largest force there was, each way across the shaft.
std::vector<Candidate> Candidates(const std::vector<StrainHoldResult>& holds) {
  std::vector<const StrainHoldResult*> by_depth;
  double force_N = 0;
  for (const auto& h : holds) {
    if (!h.used) continue;
    by_depth.push_back(&h);
    force_N = std::max(force_N, h.hold.f_tip_N.norm());
  }
  std::vector<Candidate> all;
  if (by_depth.empty()) return all;
  std::sort(by_depth.begin(), by_depth.end(),
            [](const auto* a, const auto* b) { return a->s_port_m < b->s_port_m; });
  for (const auto* at : {by_depth.front(), by_depth[by_depth.size() / 2], by_depth.back()}) {
    for (const double part : {-0.2, -0.1, 0.0, 0.1}) {
      Candidate c{at->hold, ""};
      const double push_m = part * at->s_port_m;
      c.hold.p_RW += push_m * at->hold.R_RW->col(0);
      const std::string where =
          fmt::format("with the port {:.3f} m from the wrist", at->s_port_m - push_m);
      c.hold.f_tip_N.setZero();
      c.words = "no load at all, " + where;
      all.push_back(c);
      for (const int axis : {1, 2}) {
        for (const double sign : {1.0, -1.0}) {
          c.hold.f_tip_N = sign * force_N * at->hold.R_RW->col(axis);
          c.words = fmt::format("{:.3g} N along the wrist's {}{} axis, {}", force_N,
                                sign < 0 ? "-" : "", axis == 1 ? "y" : "z", where);
          all.push_back(c);
        }
      }
    }
  }
  return all;
}

}  // namespace

std::string NextStrainLoad(const std::vector<StrainHoldResult>& holds, const GageFit& fit,
                           const Eigen::Vector4d& reading_sd, MomentModel& model) {
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
  const Eigen::MatrixXd information =
      unit.cwiseInverse().asDiagonal() *
      Eigen::MatrixXd(
          scaled_C.ldlt().solve(Eigen::MatrixXd::Identity(kGageUnknowns, kGageUnknowns))) *
      unit.cwiseInverse().asDiagonal();
  const double now = Uncertainty(information, unit);
  double best = now;
  std::string words;
  for (const Candidate& candidate : Candidates(holds)) {
    const auto stated = model.At(candidate.hold);
    if (!stated) continue;
    const auto J = GageRows(fit, stated->m_Nm, stated->by_port);
    Eigen::Matrix4d S = fit.gains * stated->Covariance(candidate.hold) * fit.gains.transpose();
    S.diagonal() += reading_sd.cwiseAbs2();
    const double then = Uncertainty(information + J.transpose() * S.ldlt().solve(J), unit);
    if (then >= best) continue;
    best = then;
    words = candidate.words;
  }
  if (best > (1 - kWorthwhile) * now) return "";
  return fmt::format("{} (the gains' uncertainty falls to {:.0f} %)", words, 100 * best / now);
}

}  // namespace flextip
