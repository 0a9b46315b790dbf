#include "calibration/shaft/stiffness_fit.h"

#include <algorithm>
#include <cmath>

#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

using namespace tapered_input;

constexpr int kMaxIterations = 30;
constexpr double kSettledStep = 1e-6;  // squared step in standard deviations
constexpr double kMostTaper = 1.8;
constexpr double kLeast_m = 1e-6, kLeast_rad = 1e-6, kLeast_Nm = 1e-7;

double Square(double x) { return x * x; }

/// Rows as they come, each block with its noise.
class RowStack {
 public:
  /// `residual` = measured less predicted, by the rod's inputs and by the unknowns of frames.
  void Add(const Eigen::VectorXd& residual, const Eigen::MatrixXd& by_inputs,
           const Eigen::MatrixXd& by_frames, const Eigen::MatrixXd& noise) {
    const Eigen::Index n = residual.size(), at = residual_.size();
    residual_.conservativeResize(at + n);
    residual_.tail(n) = residual;
    by_inputs_.conservativeResize(at + n, kCount);
    by_inputs_.bottomRows(n) = by_inputs;
    by_frames_.conservativeResize(at + n, 12);
    by_frames_.bottomRows(n) = by_frames;
    noise_.conservativeResize(at + n, at + n);
    noise_.rightCols(n).setZero();
    noise_.bottomRows(n).setZero();
    noise_.bottomRightCorner(n, n) = noise;
  }
  Eigen::VectorXd residual_;
  Eigen::MatrixXd by_inputs_, by_frames_, noise_;
};

/// Place and direction as a sensor whose frame is turned and shifted sees them.
struct SeenFrame {
  const StiffnessVector& x;
  const Eigen::Vector3d& centre;
  int turn;  // of the unknowns; its shift follows

  void AddPlace(const Eigen::Vector3d& measured, const Eigen::Matrix3d& covariance,
                const TaperedRodSection& s, RowStack& rows) const {
    const Eigen::Vector3d arm = s.p - centre;
    const Eigen::Vector3d p = s.p + x.segment<3>(turn).cross(arm) + x.segment<3>(turn + 3);
    Eigen::MatrixXd frames = Eigen::MatrixXd::Zero(3, 12);
    frames.middleCols<3>(turn - kVisionTurn) = -Skew(arm);
    frames.middleCols<3>(turn - kVisionTurn + 3).setIdentity();
    rows.Add(measured - p, s.dp, frames,
             covariance + Square(kLeast_m) * Eigen::Matrix3d::Identity());
  }
  void AddDirection(const Eigen::Vector3d& measured, double noise_rad, const TaperedRodSection& s,
                    RowStack& rows) const {
    const Eigen::Matrix<double, 2, 3> across = NormalBasis(measured).transpose();
    Eigen::MatrixXd frames = Eigen::MatrixXd::Zero(2, 12);
    frames.middleCols<3>(turn - kVisionTurn) = -across * Skew(s.t);
    rows.Add(-across * (s.t + x.segment<3>(turn).cross(s.t)), across * s.dt, frames,
             Square(std::max(noise_rad, kLeast_rad)) * Eigen::Matrix2d::Identity());
  }
};

void AddWristDirection(const LoadHold& hold, const TaperedRodSection& wrist, RowStack& rows) {
  const Eigen::Matrix<double, 2, 3> across = NormalBasis(hold.R_RW->col(0)).transpose();
  rows.Add(-across * wrist.t, across * wrist.dt, Eigen::MatrixXd::Zero(2, 12),
           Square(std::max(hold.wrist_turn_noise_rad, kLeast_rad)) * Eigen::Matrix2d::Identity());
}

void AddMoments(const LoadHold& hold, double noise_Nm, const TaperedRodState& rod, RowStack& rows) {
  Eigen::Vector4d m, by_roll;
  Eigen::MatrixXd d(4, kCount);
  for (int i = 0; i < 2; ++i) {
    const TaperedRodSection& s = rod.stations[i];
    const Eigen::Vector3d z = s.t.cross(s.y);
    m.segment<2>(2 * i) << s.m.dot(s.y), s.m.dot(z);
    by_roll.segment<2>(2 * i) << s.m.dot(z), -s.m.dot(s.y);
    d.row(2 * i) = s.y.transpose() * s.dm + s.m.transpose() * s.dy;
    // m . d(t x y) = (y x m) . dt + (m x t) . dy
    d.row(2 * i + 1) = z.transpose() * s.dm + s.y.cross(s.m).transpose() * s.dt +
                       s.m.cross(s.t).transpose() * s.dy;
  }
  rows.Add(*hold.readings - m, d, Eigen::MatrixXd::Zero(4, 12),
           (Square(noise_Nm) / hold.samples + Square(kLeast_Nm)) * Eigen::Matrix4d::Identity() +
               Square(hold.wrist_turn_noise_rad) * by_roll * by_roll.transpose());
}

}  // namespace

StiffnessFitter::StiffnessFitter(const StiffnessSetup& setup, const std::vector<LoadHold>& holds)
    : setup_(setup), holds_(holds), hidden_(holds.size()), solvers_(holds.size()) {}

StiffnessRows StiffnessFitter::Rows(const LoadHold& hold, const StiffnessVector& x,
                                    TaperedRodSolver& solver, Hidden& hidden) const {
  TaperedRodProblem problem;
  RodProblem& rod = problem.rod;
  rod.length_m = setup_.instrument.length_m;
  rod.bending_stiffness_Nm2 = std::exp(x[kLogStiffness]);
  rod.p_wrist = hold.p_RW + hidden.d.tail<3>();
  rod.p_port = setup_.p_RP + x.segment<3>(kStiffnessPort);
  rod.f_tip = hold.f_tip_N + hidden.d.head<3>();
  rod.q_weight = setup_.instrument.mass_per_length_kg_m * setup_.gravity_m_s2;
  problem.rod.stiffness_taper = x[kStiffnessTaper];
  problem.y_wrist =
      hold.R_RW ? Eigen::Vector3d(hold.R_RW->col(1))
                : Eigen::Vector3d(NormalBasis((rod.p_port - rod.p_wrist).normalized()).col(0));
  const double stations[] = {setup_.stations_m[0], setup_.stations_m[1],
                             rod.length_m - setup_.em_from_tip_m};
  const bool strain = setup_.moment_noise_Nm > 0 && hold.readings && hold.R_RW;
  const std::span<const double> asked =
      strain ? std::span<const double>(stations, 3) : std::span<const double>(stations + 2, 1);
  StiffnessRows out;
  const TaperedRodState state = solver.Solve(problem, asked);
  if (!state.usable) return out;
  RowStack rows;
  const SeenFrame vision{x, setup_.centre, kVisionTurn}, em{x, setup_.centre, kEmTurn};
  if (hold.p_RE) vision.AddPlace(*hold.p_RE, hold.p_RE_covariance_m2, state.tip, rows);
  if (hold.T_RS) {
    const TaperedRodSection& s = state.stations.back();
    em.AddPlace(hold.T_RS->p, Square(hold.em_noise_m) * Eigen::Matrix3d::Identity(), s, rows);
    em.AddDirection(hold.T_RS->R.col(0), hold.em_turn_noise_rad, s, rows);
  }
  if (hold.d_RE) vision.AddDirection(*hold.d_RE, hold.direction_noise_rad, state.tip, rows);
  if (hold.R_RW) AddWristDirection(hold, state.wrist, rows);
  if (strain) AddMoments(hold, setup_.moment_noise_Nm, state, rows);
  if (rows.residual_.size() == 0) return out;

  Eigen::MatrixXd H(rows.residual_.size(), 6);
  H << rows.by_inputs_.middleCols<3>(kForce), rows.by_inputs_.middleCols<3>(kWrist);
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(Square(hold.force_noise_N)),
      Eigen::Vector3d::Constant(Square(hold.wrist_noise_m));
  out.usable = true;
  out.has_place = hold.p_RE || hold.T_RS;
  out.s_port_m = state.s_port_m;
  // With load and wrist as stated, to first order.
  out.residual = rows.residual_ + H * hidden.d;
  out.covariance = rows.noise_ + H * variance.asDiagonal() * H.transpose();
  out.by_unknowns.resize(out.residual.size(), kStiffnessUnknowns);
  out.by_unknowns << rows.by_inputs_.col(kStiffness), rows.by_inputs_.col(kTaper),
      rows.by_inputs_.middleCols<3>(kPort), rows.by_frames_;
  hidden.gain = variance.asDiagonal() * H.transpose();
  return out;
}

StiffnessRows StiffnessFitter::RowsOf(const LoadHold& hold, const StiffnessVector& x) {
  TaperedRodSolver solver;
  Hidden hidden;
  return Rows(hold, x, solver, hidden);
}

StiffnessVector StiffnessFitter::PriorInformation() const {
  const auto of = [](double sd) { return sd > 0 ? 1 / Square(sd) : 1e30; };
  StiffnessVector prior(kStiffnessUnknowns);
  prior[kLogStiffness] = 1e-6;
  prior[kStiffnessTaper] = of(setup_.taper_prior);
  prior.segment<3>(kStiffnessPort).setConstant(of(setup_.port_noise_m));
  prior.segment<3>(kVisionTurn).setConstant(of(setup_.vision_turn_rad));
  prior.segment<3>(kVisionShift).setConstant(of(setup_.vision_shift_m));
  prior.segment<3>(kEmTurn).setConstant(of(setup_.em_turn_rad));
  prior.segment<3>(kEmShift).setConstant(of(setup_.em_shift_m));
  return prior;
}

/// Fills the equations and the fit's rows at `x`; the cost.
double StiffnessFitter::Evaluate(const StiffnessVector& x, const std::vector<double>& weights,
                                 StiffnessMatrix& N, StiffnessVector& gradient, StiffnessFit& fit) {
  const StiffnessVector prior = PriorInformation();
  const StiffnessVector from_prior = x - Nominal();
  N = prior.asDiagonal();
  gradient = -prior.cwiseProduct(from_prior);
  double cost = from_prior.dot(prior.cwiseProduct(from_prior));
  fit.rows.resize(holds_.size());
  for (std::size_t i = 0; i < holds_.size(); ++i) {
    StiffnessRows& rows = fit.rows[i];
    rows = Rows(holds_[i], x, solvers_[i], hidden_[i]);
    if (!rows.usable) continue;
    const Ldlt S(rows.covariance);
    const Eigen::VectorXd solved = S.Solve(rows.residual);
    hidden_[i].d = hidden_[i].gain * solved;  // the most likely ones, for the next time
    if (weights[i] == 0) continue;
    N += weights[i] * rows.by_unknowns.transpose() * S.Solve(rows.by_unknowns);
    gradient += weights[i] * rows.by_unknowns.transpose() * solved;
    cost += weights[i] * rows.residual.dot(solved);
  }
  return cost;
}

StiffnessVector StiffnessFitter::Nominal() const {
  return StiffnessVector::Unit(kStiffnessUnknowns, kLogStiffness) *
         std::log(setup_.instrument.bending_stiffness_Nm2);
}

/// Damped: towards a taper that the loads say little of, plain steps overshoot.
StiffnessFit StiffnessFitter::Fit(const std::vector<double>& weights,
                                  const StiffnessVector& start) {
  StiffnessFit fit, next;
  fit.x = start;
  StiffnessMatrix N, next_N;
  StiffnessVector gradient, next_gradient;
  const double cost = Evaluate(fit.x, weights, N, gradient, fit);
  std::vector<Hidden> hidden = hidden_;
  const auto try_step = [&](double damping) -> TrialStep {
    const StiffnessVector dx = DampedStep(N, -gradient, damping);
    next.x = fit.x + dx;
    next.x[kStiffnessTaper] = std::clamp(next.x[kStiffnessTaper], -kMostTaper, kMostTaper);
    hidden_ = hidden;
    const double next_cost = Evaluate(next.x, weights, next_N, next_gradient, next);
    const bool settled = dx.dot(N * dx) < kSettledStep;
    // A hold whose rod has no equilibrium drops out of the cost: that is no progress.
    const bool progress = settled || next.Usable() >= fit.Usable();
    return {.cost = progress ? next_cost : HUGE_VAL, .settled = settled};
  };
  const auto accept = [&] {
    fit = next;
    N = next_N;
    gradient = next_gradient;
    hidden = hidden_;
  };
  const DescentResult descent = Descend(cost, try_step, accept,
                                        {.max_iterations = kMaxIterations,
                                         .start_damping = 0.0,
                                         .least_damping = 1e-7,
                                         .floor = 0.0,
                                         .least_raised = 1e-4,
                                         .most_damping = 1e6,
                                         .relative_gain = 0.0,
                                         .allowed_rise = 1e-9});
  fit.converged = descent.settled;
  hidden_ = hidden;
  const StiffnessVector unit = N.diagonal().cwiseSqrt().cwiseInverse();
  const StiffnessMatrix scaled = unit.asDiagonal() * N * unit.asDiagonal();
  fit.information = N;
  fit.covariance = unit.asDiagonal() * Ldlt(scaled).Inverse() * unit.asDiagonal();
  return fit;
}

}  // namespace flextip
