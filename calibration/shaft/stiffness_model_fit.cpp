#include "calibration/shaft/stiffness_model_fit.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr std::size_t kFolds = 8;
constexpr double kMostOutliers = 0.1;  // of the holds: more is the model

/// chi2 of `n` over what a hold with plain noise hardly ever exceeds.
double Excess(double chi2, double n) { return chi2 / (n + 8 * std::sqrt(2 * n)); }

}  // namespace

StiffnessModelFit::StiffnessModelFit(const StiffnessSetup& setup,
                                     const std::vector<LoadHold>& holds)
    : fitter_(setup, holds), weights_(holds.size(), 1.0), taper_(setup.taper_prior > 0) {
  fit_ = fitter_.Fit(weights_, fitter_.Nominal());
  RejectOutliers();
  Score();
  HoldOut();
}

bool StiffnessModelFit::IsIncomplete() const {
  return model_.chi2_per_dof > std::max(1.3, 1 + 5 * std::sqrt(2 / freedoms_));
}

/// Where many are far off it is not they who are wrong: then all stay.
void StiffnessModelFit::RejectOutliers() {
  for (int round = 0; round < 4 && fit_.converged; ++round) {
    std::vector<double> ratios;
    for (const StiffnessRows& rows : fit_.rows) {
      const auto n = static_cast<double>(rows.residual.size());
      if (rows.usable) ratios.push_back(rows.Chi2() / (n * std::pow(1 - 2 / (9 * n), 3)));
    }
    const double scale = std::max(1.0, Median(ratios));
    std::vector<double> weights(weights_.size(), 1.0);
    double out = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const StiffnessRows& rows = fit_.rows[i];
      if (!rows.usable) continue;
      if (Excess(rows.Chi2() / scale, static_cast<double>(rows.residual.size())) < 1) continue;
      weights[i] = 0;
      ++out;
    }
    if (out > kMostOutliers * static_cast<double>(ratios.size())) weights.assign(weights.size(), 1);
    if (weights == weights_) return;
    weights_ = weights;
    fit_ = fitter_.Fit(weights_, fit_.x);
  }
}

void StiffnessModelFit::Score() {
  double chi2 = 0, squares = 0, places = 0;
  freedoms_ = taper_ ? -2 : -1;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const StiffnessRows& rows = fit_.rows[i];
    if (!rows.usable || weights_[i] == 0) continue;
    chi2 += rows.Chi2();
    freedoms_ += static_cast<double>(rows.residual.size());
    if (!rows.has_place) continue;
    squares += rows.residual.head<3>().squaredNorm();
    ++places;
  }
  freedoms_ = std::max(freedoms_, 1.0);
  model_.converged = fit_.converged;
  model_.chi2_per_dof = chi2 / freedoms_;
  model_.tip_rms_m = std::sqrt(squares / std::max(places, 1.0));
  model_.stiffness_Nm2 = std::exp(fit_.x[kLogStiffness]);
  model_.taper = fit_.x[kStiffnessTaper];
}

/// Each block of the recording by a fit to the others, to first order about the whole fit. How the
/// blocks' fits scatter (a jackknife) also says how much the model's own misfit leaves in doubt.
void StiffnessModelFit::HoldOut() {
  const std::size_t n = weights_.size();
  double squares = 0, places = 0, chi2 = 0, measurements = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), sum_squares = sum;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    StiffnessMatrix N = fit_.information;
    StiffnessVector gradient = StiffnessVector::Zero(kStiffnessUnknowns);
    const std::size_t first = fold * n / kFolds, last = (fold + 1) * n / kFolds;
    for (std::size_t i = first; i < last; ++i) {
      const StiffnessRows& rows = fit_.rows[i];
      if (!rows.usable || weights_[i] == 0) continue;
      const Ldlt S(rows.covariance);
      N -= rows.by_unknowns.transpose() * S.Solve(rows.by_unknowns);
      gradient -= rows.by_unknowns.transpose() * S.Solve(rows.residual);
    }
    const StiffnessVector unit = N.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const StiffnessMatrix scaled = unit.asDiagonal() * N * unit.asDiagonal();
    const StiffnessVector dx = unit.cwiseProduct(Ldlt(scaled).Solve(unit.cwiseProduct(gradient)));
    sum += dx.head<2>();
    sum_squares += dx.head<2>().cwiseAbs2();
    for (std::size_t i = first; i < last; ++i) {
      const StiffnessRows& rows = fit_.rows[i];
      if (!rows.usable || weights_[i] == 0) continue;
      const Eigen::VectorXd e = rows.residual - rows.by_unknowns * dx;
      chi2 += e.dot(Ldlt(rows.covariance).Solve(e));
      measurements += static_cast<double>(e.size());
      if (!rows.has_place) continue;
      squares += e.head<3>().squaredNorm();
      ++places;
    }
  }
  model_.heldout_tip_rms_m = std::sqrt(squares / std::max(places, 1.0));
  model_.heldout_chi2 = chi2 / std::max(measurements, 1.0);
  double wider = std::max(1.0, model_.chi2_per_dof);
  if (IsIncomplete()) {
    constexpr double k = kFolds;
    const Eigen::Vector2d jackknife = (k - 1) / k * (sum_squares - sum.cwiseAbs2() / k);
    for (int i = 0; i < (taper_ ? 2 : 1); ++i) {
      wider = std::max(wider, jackknife[i] / fit_.covariance(i, i));
    }
  }
  covariance_ = wider * fit_.covariance;
  model_.stiffness_sd_Nm2 = model_.stiffness_Nm2 * std::sqrt(covariance_(0, 0));
  model_.taper_sd = taper_ ? std::sqrt(covariance_(1, 1)) : 0.0;
}

}  // namespace flextip
