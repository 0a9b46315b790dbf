#include "estimation/shaft_estimator.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/linear_algebra.h"
#include "estimation/beam_choice.h"
#include "estimation/rod_fit.h"

namespace flextip {
namespace {

constexpr double kObservable = 0.3;  // posterior over prior sd of the force across the shaft
constexpr double kDoubtful = 0.005;  // sd of the tip over L past which a load has to stand out
constexpr double kMisfit = 100.0;    // chi2 a measurement past which another start is tried
// So it is from here on where the last fit was so many times nearer: a shaft that is not the
// model's misfits more and more, and a fit that is at another load each time is no better.
constexpr double kSuddenMisfit = 10.0;
constexpr double kSudden = 4.0;
constexpr double kModestForces[] = {1.0, 2.0};  // sd of the force, EI / L^2, of those starts
// A fit that goes on along the shaft, where the sensors say little, ends at a large load more often
// than at the true one (WindowEstimator.CovarianceOfThePortMatchesMonteCarlo fails with 60).
constexpr int kMaxDamped = 20;

// A start that is farther from the prior's mean, in standard deviations, comes from other sensors.
constexpr double kNearStart = 3.0;

// Gauss-Newton. Each step leaves far less than its own length, so that after a step of 1e-3
// standard deviations nothing that counts is left. One of 1e-4 is not worth a rod.
constexpr int kMaxGaussNewton = 8;
constexpr double kSettled = 1e-6;   // squared step in standard deviations
constexpr double kNothing = 1e-8;   // the same
constexpr double kLeastGain = 0.1;  // of the gain that the linear model promises

/// Returns whether nothing of what is handed on for control is infinite or not a number.
bool IsFinite(const ShaftEstimate& e) {
  return e.covariance.allFinite() && e.p_RE.allFinite() && e.p_RE_covariance_m2.allFinite() &&
         e.d_RE.allFinite() && std::isfinite(e.s_port_m) && std::isfinite(e.chi2);
}

/// Returns whether the standard deviations a priori are ones.
bool HasPriors(const EstimatorOptions& options) {
  constexpr double kWidest = 1e6;
  return options.port_prior_m >= 0.0 && options.port_prior_m <= kWidest &&
         options.force_prior_units > 0.0 && options.force_prior_units <= kWidest;
}

RodPrior Prior(const EstimatorOptions& options, const Measurements& z, const ShaftModel& model) {
  RodPrior prior;
  prior.mean << z.p_RW + model.wrist_shift_m, model.p_RP, Eigen::Vector3d::Zero();
  prior.sd << Eigen::Vector3d::Constant(std::max(z.wrist_position_noise_m, 1e-6)),
      Eigen::Vector3d::Constant(std::max(options.port_prior_m, 1e-6)),
      Eigen::Vector3d::Constant(options.force_prior_units);
  return prior;
}

/// The straight-shaft model that is handed on where nothing better is known.
ShaftModel StraightModel(const EstimatorOptions& options, const ShaftChange& change) {
  ShaftModel model;
  model.instrument = options.instrument;
  model.instrument.length_m += change.length_delta_m;
  model.instrument.bending_stiffness_Nm2 *= change.stiffness_scale;
  model.p_RP = options.p_RP + change.port_shift_m;
  model.weight_N_m =
      options.instrument.mass_per_length_kg_m * options.gravity_m_s2 + change.weight_N_m;
  model.effects = change.effects;
  model.tip_compliance_m_N = change.tip_compliance_m_N;
  model.wrist_shift_m = change.wrist_shift_m;
  model.wrist_misread_m = change.wrist_misread_m;
  model.wrist_play_m = change.wrist_play_m;
  model.beam.status = BeamStatus::kStraight;
  return model;
}

/// Returns J^T J.
Matrix9d Information(const RodFit::Jacobian& jacobian) {
  Matrix9d information;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j <= i; ++j) {
      information(i, j) = information(j, i) = jacobian.col(i).dot(jacobian.col(j));
    }
  }
  return information;
}

/// Goes from `x` to the least squares by steps without damping. Returns false where the sum of
/// squares does not fall, as far from the end; `x` is then what it was.
bool GaussNewton(const RodFit& fit, RodParameters& x) {
  RodFit::Residuals r;
  RodFit::Jacobian J;
  RodParameters at = x;
  if (!fit(at.data(), r.data(), J.data())) return false;
  for (int i = 0; i < kMaxGaussNewton; ++i) {
    const RodParameters gradient = J.transpose() * r;
    const RodParameters step = -Ldlt(Information(J)).Solve(gradient);
    const double cost = r.squaredNorm(), gain = -step.dot(gradient);
    if (!(gain >= 0.0)) return false;
    const bool settled = gain < kSettled;
    if (gain >= kNothing) {
      const RodParameters next = at + step;
      if (!fit(next.data(), r.data(), J.data())) return false;
      // What the rod is solved to is more than a tenth of the least gains.
      const double most = settled ? cost + kSettled : cost - kLeastGain * gain;
      if (!(r.squaredNorm() <= most)) return false;
      at = next;
    }
    if (!settled) continue;
    x = at;
    return true;
  }
  return false;
}

}  // namespace

const char* Name(EstimateStatus status) {
  switch (status) {
    case EstimateStatus::kOk:
      return "ok";
    case EstimateStatus::kUnobservable:
      return "unobservable";
    case EstimateStatus::kNotConverged:
      return "not_converged";
    case EstimateStatus::kBadInput:
      return "bad_input";
  }
  return "";
}

EstimatorOptions EstimatorOptionsFor(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                                     const Eigen::Vector3d& gravity_m_s2, double port_prior_m) {
  EstimatorOptions options;
  options.instrument = instrument;
  options.p_RP = p_RP;
  options.gravity_m_s2 = gravity_m_s2;
  options.port_prior_m = port_prior_m;
  return options;
}

ShaftEstimator::ShaftEstimator(const EstimatorOptions& options) : options_(options) {}

void ShaftEstimator::Reset() { *this = ShaftEstimator(options_); }

void ShaftEstimator::SetPort(const Eigen::Vector3d& shift_m, const Eigen::Matrix3d& covariance_m2) {
  const Llt cholesky(covariance_m2);
  FLEXTIP_CHECK(cholesky.Succeeded(), "a positive definite covariance");
  port_shift_m_ = shift_m;
  port_whitening_ = cholesky.SolveL(Eigen::Matrix3d::Identity());
}

ShaftEstimate ShaftEstimator::Update(const Measurements& z, const ShaftChange& change) {
  ShaftEstimate estimate;
  const ShaftModel straight = StraightModel(options_, change);
  // A change or data that no shaft has are not handed on.
  if (!IsPlausible(straight)) return estimate;
  estimate.model = straight;
  if (!IsPlausible(z) || !HasPriors(options_)) return estimate;

  const ShaftProblem shaft = RodOf(estimate.model, z.p_RW);
  RodPrior prior = Prior(options_, z, estimate.model);
  prior.mean.segment<3>(3) += port_shift_m_;
  prior.port_whitening = port_whitening_;
  RodFit fit(shaft, z, prior, options_.use_positions, solver_);
  // A sample that is asked about again starts where its fit ended. A new one has noise of its own.
  RodParameters x = prior.mean;
  const auto near = [](const Eigen::Vector3d& shift_m, double sd_m) {
    return shift_m.norm() < kNearStart * sd_m;
  };
  if (z.p_RW == last_.p_RW && near(last_.wrist_m, prior.sd[0]) && near(last_.port_m, prior.sd[3])) {
    x.head<3>() += last_.wrist_m;
    x.segment<3>(3) += last_.port_m;
  }
  x.tail<3>() = last_.force_N / fit.ForceUnit();

  if (!IsPlain(change.effects) && last_.force_N.isZero(0.0)) {
    // Without a past the steps may be long. The plain shaft's force is a start near enough.
    ShaftProblem plain = shaft;
    plain.rod.effects = RodEffects();
    RodFit first(plain, z, prior, options_.use_positions, solver_);
    if (!Fit(first, x, estimate)) x = prior.mean;
    if (!Fit(fit, x, estimate)) x = prior.mean;  // one round more
  }
  const auto give_up = [&] {
    ShaftEstimate nothing;
    nothing.model = straight;
    nothing.status = EstimateStatus::kNotConverged;
    nothing.from_all_starts = estimate.from_all_starts;
    last_ = {};
    return nothing;
  };
  if (!FitFromAnyStart(fit, x, estimate)) return give_up();
  last_.misfit = estimate.chi2 / (1 + estimate.measurements);
  if (options_.compare_sensors) estimate.misfits = fit.MisfitsAt(x, estimate.covariance);
  Describe(fit, x, estimate);
  if (!IsFinite(estimate)) return give_up();
  FillModel(fit, x, z, estimate);
  if (IsPlausible(estimate.model)) return estimate;
  tissue_ = TissueSecants();
  return give_up();
}

bool ShaftEstimator::FitFromAnyStart(RodFit& fit, RodParameters& x, ShaftEstimate& estimate) {
  const RodParameters unloaded = fit.PriorMean();
  bool ok = Fit(fit, x, estimate);
  const double most =
      last_.misfit > 0.0 ? std::clamp(kSudden * last_.misfit, kSuddenMisfit, kMisfit) : kMisfit;
  const auto fits = [&] { return ok && estimate.chi2 < most * (1 + estimate.measurements); };
  // With effects a fit that is not at the bottom yet goes on from here with the next sample.
  if (fits() || (ok && !IsPlain(estimate.model.effects))) return ok;

  const auto try_from = [&](RodParameters start) {
    ShaftEstimate other = estimate;
    if (!Fit(fit, start, other) || (ok && other.chi2 >= estimate.chi2)) return;
    ok = true;
    x = start;
    estimate = other;
  };
  // The last force may be far from this one. Or a step went too far along the shaft, where the
  // sensors say little, and the fit ended at a shaft that has buckled or is pulled straight: a
  // start from the best modest force stays clear of both.
  if (!last_.force_N.isZero(0.0)) {
    solver_.Reset();
    try_from(unloaded);
  }
  for (const double sd : kModestForces) {
    if (fits()) break;
    solver_.Reset();
    RodFit modest = fit;
    modest.LimitForce(sd);
    RodParameters start = unloaded;
    ShaftEstimate unused = estimate;
    if (Fit(modest, start, unused)) try_from(start);
  }
  estimate.from_all_starts = !fits();
  return ok;
}

bool ShaftEstimator::Fit(RodFit& fit, RodParameters& x, ShaftEstimate& estimate) {
  ceres::TinySolver<RodFit> solver;
  solver.options.max_num_iterations = kMaxDamped;
  solver.options.cost_threshold = 1e-12;
  solver.options.gradient_tolerance = 1e-9;
  solver.options.parameter_tolerance = 1e-10;
  RodFit::Residuals residuals;
  RodFit::Jacobian jacobian;
  // The last force is the usual start; where the rod has no equilibrium there, the unloaded shaft.
  if (!fit(x.data(), residuals.data(), nullptr)) {
    x.tail<3>().setZero();
    if (!fit(x.data(), residuals.data(), nullptr)) return false;
  }
  if (!GaussNewton(fit, x)) solver.Solve(fit, &x);
  if (!x.allFinite() || !fit(x.data(), residuals.data(), jacobian.data())) return false;
  estimate.chi2 = residuals.squaredNorm();
  estimate.measurements = fit.MeasurementCount();
  estimate.covariance = Ldlt(Information(jacobian)).Inverse();
  return estimate.covariance.allFinite();
}

void ShaftEstimator::Describe(const RodFit& fit, const RodParameters& x, ShaftEstimate& estimate) {
  const ShaftRodState& rod = fit.RodAt(x);
  estimate.p_RE = rod.p_RE;
  estimate.d_RE = rod.end.t;
  estimate.s_port_m = rod.s_port_m;
  // Observable: what the sensors say of the force across the shaft narrows the prior.
  const Eigen::Matrix3d force = estimate.covariance.bottomRightCorner<3, 3>();
  const Eigen::Vector3d t = rod.t_port;
  const double across = std::sqrt(0.5 * std::max(0.0, force.trace() - t.dot(force * t)));
  // From units of EI / L^2 to newton.
  estimate.covariance.rightCols<3>() *= fit.ForceUnit();
  estimate.covariance.bottomRows<3>() *= fit.ForceUnit();
  estimate.p_RE_covariance_m2 = rod.dp_RE * estimate.covariance * rod.dp_RE.transpose();
  const bool seen = across < kObservable * options_.force_prior_units;
  estimate.status =
      seen && StandsOut(fit, rod, estimate) ? EstimateStatus::kOk : EstimateStatus::kUnobservable;
}

bool ShaftEstimator::StandsOut(const RodFit& fit, const ShaftRodState& rod,
                               const ShaftEstimate& estimate) {
  const double variance = estimate.p_RE_covariance_m2.trace();
  const double L = estimate.model.instrument.length_m;
  if (variance < kDoubtful * kDoubtful * L * L) return true;
  ShaftProblem unloaded = fit.ProblemAt(fit.PriorMean());
  unloaded.rod.rod.f_tip.setZero();
  const ShaftRodState straight = ShaftRod().Solve(unloaded);
  // The square of the bend as estimated is that of the true one and the variance: below twice the
  // variance the unloaded shaft is the better guess.
  return straight.IsUsable() && (rod.p_RE - straight.p_RE).squaredNorm() > 2.0 * variance;
}

void ShaftEstimator::FillModel(const RodFit& fit, const RodParameters& x, const Measurements& z,
                               ShaftEstimate& estimate) {
  ShaftModel& model = estimate.model;
  model.p_RP = fit.PriorMean().segment<3>(3);
  if (estimate.status != EstimateStatus::kOk) return;
  model.p_RP = x.segment<3>(3);
  model.f_tip_N = x.tail<3>() * fit.ForceUnit();
  model.force_known = true;
  last_.p_RW = z.p_RW;
  last_.wrist_m = x.head<3>() - fit.PriorMean().head<3>();
  last_.port_m = x.segment<3>(3) - fit.PriorMean().segment<3>(3);
  last_.force_N = model.f_tip_N;
  if (options_.fit_beam)
    model.beam = ChooseBeamFit(z, model.instrument, model, options_.use_positions);
  if (options_.estimate_tissue) {
    // A fit that misses by more than its noise knows its force by so much less.
    const double misfit = std::max(1.0, estimate.chi2 / std::max(1, estimate.measurements));
    tissue_.Add(estimate.p_RE, model.f_tip_N,
                misfit * estimate.covariance.bottomRightCorner<3, 3>());
  }
  model.tissue_stiffness_N_m = tissue_.Stiffness();
}

}  // namespace flextip
