#include "estimation/window_estimator.h"

#include <algorithm>
#include <limits>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kNarrowed = 0.5;  // posterior over prior sd of the port across the shaft

}  // namespace

const char* Name(WindowStatus status) {
  switch (status) {
    case WindowStatus::kOk:
      return "ok";
    case WindowStatus::kUnobservable:
      return "unobservable";
    case WindowStatus::kNotConverged:
      return "not_converged";
  }
  return "";
}

WindowEstimator::WindowEstimator(const WindowOptions& options)
    : options_(options),
      latest_(options.estimator),
      port_(options.samples, options.estimator.port_prior_m, options.estimator.use_positions) {}

void WindowEstimator::Reset() {
  latest_.Reset();
  port_.Reset();
  status_ = WindowStatus::kUnobservable;
}

void WindowEstimator::TellLatest() {
  if (status_ == WindowStatus::kOk) {
    latest_.SetPort(port_.Shift(), port_.Covariance());
    return;
  }
  const double sd = std::max(options_.estimator.port_prior_m, 1e-6);
  latest_.SetPort(Eigen::Vector3d::Zero(), sd * sd * Eigen::Matrix3d::Identity());
}

WindowEstimate WindowEstimator::Update(const Measurements& z, const ShaftChange& change) {
  ++updates_;
  WindowEstimate estimate;
  TellLatest();
  estimate.shaft = latest_.Update(z, change);
  const bool carried_on = z.tip && z.tip->status == TipStatus::kPredicted;  // says nothing new
  const bool fits = estimate.shaft.status == EstimateStatus::kOk ||
                    estimate.shaft.status == EstimateStatus::kUnobservable;
  if (fits && !carried_on) Add(z, change, estimate.shaft);
  const bool refined = port_.Refine();
  estimate.port_shift_m = port_.Shift();
  estimate.port_covariance_m2 = port_.Covariance();
  estimate.samples = port_.Size();
  estimate.chi2 = port_.Chi2();
  Describe(estimate);
  if (!refined) estimate.status = WindowStatus::kNotConverged;
  status_ = estimate.status;
  return estimate;
}

void WindowEstimator::Add(const Measurements& z, const ShaftChange& change,
                          const ShaftEstimate& estimate) {
  const ShaftModel& model = estimate.model;
  WindowSample sample;
  sample.number = updates_;
  sample.measurements = z;
  sample.shaft = RodOf(model, z.p_RW);
  const Eigen::Vector3d p_wrist = z.p_RW + model.wrist_shift_m;
  sample.prior.mean << p_wrist, options_.estimator.p_RP + change.port_shift_m,
      Eigen::Vector3d::Zero();
  sample.prior.sd << Eigen::Vector3d::Constant(std::max(z.wrist_position_noise_m, 1e-6)),
      Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
      Eigen::Vector3d::Constant(options_.estimator.force_prior_units);
  const double L = model.instrument.length_m;
  sample.own << p_wrist, model.f_tip_N * (L * L / model.instrument.bending_stiffness_Nm2);
  port_.Add(sample);
}

void WindowEstimator::Describe(WindowEstimate& estimate) const {
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(estimate.shaft.d_RE);
  const Eigen::Matrix2d covariance = across.transpose() * estimate.port_covariance_m2 * across;
  const SymmetricEigen axes(covariance);
  estimate.least_known = across * axes.vectors.col(1);
  estimate.least_known_sd_m = std::sqrt(std::max(0.0, axes.values[1]));
  estimate.status = estimate.least_known_sd_m < kNarrowed * options_.estimator.port_prior_m
                        ? WindowStatus::kOk
                        : WindowStatus::kUnobservable;
}

}  // namespace flextip
