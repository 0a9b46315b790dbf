#include "estimation/rod_fit.h"

#include <algorithm>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

// No sensor is believed beyond these, so that noise-free simulated data keep a finite weight.
constexpr double kLeastPosition_m = 1e-6, kLeastAngle_rad = 1e-6, kLeastMoment_Nm = 1e-6,
                 kLeastForce_N = 1e-5;

/// W with W^T W the inverse of the covariance, its variances floored.
Eigen::Matrix3d Whitening(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d floored =
      covariance + kLeastPosition_m * kLeastPosition_m * Eigen::Matrix3d::Identity();
  return Llt(floored).SolveL(Eigen::Matrix3d::Identity());
}

Eigen::Matrix3d Whitening(double noise_m) {
  return Eigen::Matrix3d::Identity() / std::max(noise_m, kLeastPosition_m);
}

}  // namespace

RodFit::RodFit(const ShaftProblem& shaft, const Measurements& measurements, const RodPrior& prior,
               bool use_positions, ShaftRod& solver)
    : shaft_(shaft),
      measurements_(measurements),
      prior_(prior),
      use_positions_(use_positions),
      solver_(solver),
      force_unit_(shaft.rod.rod.bending_stiffness_Nm2 /
                  (shaft.rod.rod.length_m * shaft.rod.rod.length_m)) {
  if (measurements.strain && measurements.R_RW) {
    for (const double s : measurements.strain->station_from_wrist_m)
      stations_[station_count_++] = {s, false};
  }
  if (measurements.em) {
    em_station_ = static_cast<int>(station_count_);
    stations_[station_count_++] = {measurements.em->distance_from_tip_m, true};
  }
}

ShaftProblem RodFit::ProblemAt(const RodParameters& parameters) const {
  ShaftProblem problem = shaft_;
  problem.rod.rod.p_wrist = parameters.head<3>();
  problem.rod.rod.p_port = parameters.segment<3>(3);
  problem.rod.rod.f_tip = parameters.tail<3>() * force_unit_;
  return problem;
}

void RodFit::AddPosition(const Eigen::Vector3d& measured, const Eigen::Matrix3d& whiten,
                         const Eigen::Vector3d& p, const RodDerivative& dp) const {
  residuals_.segment<3>(rows_) = whiten * (p - measured);
  jacobian_.middleRows<3>(rows_) = whiten * dp;
  rows_ += 3;
}

void RodFit::AddDirection(const Eigen::Vector3d& measured, double noise_rad,
                          const Eigen::Vector3d& t, const RodDerivative& dt) const {
  const Eigen::Matrix<double, 2, 3> across =
      NormalBasis(measured).transpose() / std::max(noise_rad, kLeastAngle_rad);
  residuals_.segment<2>(rows_) = across * t;
  jacobian_.middleRows<2>(rows_) = across * dt;
  rows_ += 2;
}

namespace {

/// A frame carried along the shaft without twist, leg by leg. Each stretch of the shaft bends in
/// one plane, so one rotation a leg carries it. As the legs move, the frame turns about the
/// shaft by the area that the leg sweeps on the sphere of directions (its holonomy).
struct CarriedFrame {
  Eigen::Matrix3d R;  // column 0 along the shaft
  RodDerivative dt;   // of column 0
  Eigen::Matrix<double, 1, 9> twist = Eigen::Matrix<double, 1, 9>::Zero();

  void CarryTo(const Eigen::Vector3d& t, const RodDerivative& dt_new) {
    const Eigen::Vector3d from = R.col(0);
    twist -= from.cross(t).transpose() * (dt + dt_new) / (1.0 + from.dot(t));
    R = RotationWithoutTwist(from, t) * R;
    dt = dt_new;
  }
};

/// Moments about the section's y and z axes, and their derivatives.
struct LocalMoments {
  Eigen::Vector2d m;
  Eigen::Matrix<double, 2, 9> dm;
};

/// By the axes the rod itself carries along the shaft.
LocalMoments ByOwnAxes(const ShaftSection& s) {
  const Eigen::Vector3d z = s.t.cross(s.y);
  LocalMoments local;
  local.m << s.m.dot(s.y), s.m.dot(z);
  local.dm.row(0) = s.y.transpose() * s.dm + s.m.transpose() * s.dy;
  // m . d(t x y) = (y x m) . dt + (m x t) . dy
  local.dm.row(1) =
      z.transpose() * s.dm + s.y.cross(s.m).transpose() * s.dt + s.m.cross(s.t).transpose() * s.dy;
  return local;
}

/// By a frame carried along: the moment has no part along the shaft.
LocalMoments ByFrame(const CarriedFrame& frame, const ShaftSection& s) {
  LocalMoments local;
  local.m = frame.R.rightCols<2>().transpose() * s.m;
  local.dm = frame.R.rightCols<2>().transpose() * s.dm +
             Eigen::Vector2d(local.m[1], -local.m[0]) * frame.twist;
  return local;
}

}  // namespace

void RodFit::AddStrain(const ShaftRodState& rod) const {
  CarriedFrame frame{*measurements_.R_RW, RodDerivative::Zero()};
  if (!rod.has_axes) frame.CarryTo(rod.wrist.t, rod.wrist.dt);
  bool beyond_port = false;
  const double noise = std::max(measurements_.strain->moment_noise_Nm, kLeastMoment_Nm);
  for (int i = 0; i < 2; ++i) {
    const ShaftSection& section = rod.stations[i];
    if (!rod.has_axes) {
      if (section.s_m > rod.s_port_m && !beyond_port) frame.CarryTo(rod.t_port, rod.dt_port);
      beyond_port = section.s_m > rod.s_port_m;
      frame.CarryTo(section.t, section.dt);
    }
    const LocalMoments local = rod.has_axes ? ByOwnAxes(section) : ByFrame(frame, section);
    residuals_.segment<2>(rows_) =
        (local.m - measurements_.strain->moments_Nm.segment<2>(2 * i)) / noise;
    jacobian_.middleRows<2>(rows_) = local.dm / noise;
    rows_ += 2;
  }
}

void RodFit::AddSensors(const ShaftRodState& rod, const RodParameters& x) const {
  const Measurements& z = measurements_;
  sensor_rows_[0] = {0, 3};  // the prior of the wrist
  std::size_t sensor = 1;
  auto end_sensor = [&, from = rows_]() mutable {
    sensor_rows_[sensor++] = {from, rows_ - from};
    from = rows_;
  };
  if (z.R_RW) {
    AddDirection(z.R_RW->col(0), z.wrist_orientation_noise_rad, rod.wrist.t, rod.wrist.dt);
  }
  end_sensor();
  if (z.tip && z.tip->status != TipStatus::kLost) {
    if (use_positions_)
      AddPosition(z.tip->p_RE, Whitening(z.tip->covariance_m2), rod.p_RE, rod.dp_RE);
    if (z.tip->d_RE) AddDirection(*z.tip->d_RE, z.tip_direction_noise_rad, rod.end.t, rod.end.dt);
  }
  end_sensor();
  if (z.em) {
    const ShaftSection& section = rod.stations[em_station_];
    if (use_positions_)
      AddPosition(z.em->T_RS.p, Whitening(z.em->position_noise_m), section.p, section.dp);
    AddDirection(z.em->T_RS.R.col(0), z.em->orientation_noise_rad, section.t, section.dt);
  }
  end_sensor();
  if (z.port_direction) {
    AddDirection(*z.port_direction, z.port_direction_noise_rad, rod.t_port, rod.dt_port);
  }
  end_sensor();
  if (z.strain && z.R_RW) AddStrain(rod);
  end_sensor();
  if (z.load) {
    const double noise = std::max(z.load->force_noise_N, kLeastForce_N);
    residuals_.segment<3>(rows_) = (x.tail<3>() * force_unit_ - z.load->f_tip_N) / noise;
    jacobian_.block<3, 3>(rows_, 6) = Eigen::Matrix3d::Identity() / noise;
    rows_ += 3;
  }
  end_sensor();
}

void RodFit::AddPrior(const RodParameters& parameters) const {
  residuals_.head<9>() = (parameters - prior_.mean).cwiseQuotient(prior_.sd);
  jacobian_.topRows<9>() = prior_.sd.cwiseInverse().asDiagonal();
  if (prior_.port_whitening) {
    residuals_.segment<3>(3) = *prior_.port_whitening * (parameters - prior_.mean).segment<3>(3);
    jacobian_.block<3, 3>(3, 3) = *prior_.port_whitening;
  }
  rows_ = 9;
}

const ShaftRodState& RodFit::RodAt(const RodParameters& parameters) const {
  if (known_ && x_ == parameters) return rod_;
  x_ = parameters;
  known_ = true;
  filled_ = false;
  rod_ = solver_.Solve(ProblemAt(parameters), {stations_.data(), station_count_});
  return rod_;
}

bool RodFit::operator()(const double* parameters, double* residuals, double* jacobian) const {
  const RodParameters x = Eigen::Map<const RodParameters>(parameters);
  const ShaftRodState& rod = RodAt(x);
  if (!rod.IsUsable()) return false;
  if (!filled_) {
    residuals_.setZero();
    jacobian_.setZero();
    AddPrior(x);
    AddSensors(rod, x);
    // The sensors' columns were by newton; the parameter is the force in units of EI / L^2.
    jacobian_.bottomRightCorner<kMaxRodResiduals - 9, 3>() *= force_unit_;
    filled_ = true;
  }
  Eigen::Map<Residuals>(residuals, NUM_RESIDUALS) = residuals_;
  if (jacobian != nullptr)
    Eigen::Map<Jacobian>(jacobian, NUM_RESIDUALS, NUM_PARAMETERS) = jacobian_;
  return true;
}

/// By how much chi-squared falls without the rows of one sensor. With the rows' residuals r and P
/// the part of their unit covariance that the fit leaves, that is r^T P^-1 r. What the others know
/// ten times worse than the sensor itself leaves a P of a hundredth, and is not compared.
double RodFit::FallWithout(const SensorRows& rows,
                           const Eigen::Matrix<double, 9, 9>& covariance) const {
  constexpr int kMost = 6;  // a place and a direction have five
  constexpr double kAlone = 0.01;
  const auto J = jacobian_.middleRows(rows.from, rows.count);
  const Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor, kMost, 9> JC = J * covariance;
  Eigen::Matrix<double, kMost, kMost> P = Eigen::Matrix<double, kMost, kMost>::Identity();
  P.topLeftCorner(rows.count, rows.count) -= JC * J.transpose();
  P.diagonal().array() += kAlone;
  Eigen::Matrix<double, kMost, 1> r = Eigen::Matrix<double, kMost, 1>::Zero();
  r.head(rows.count) = residuals_.segment(rows.from, rows.count);
  return r.dot(Ldlt(P).Solve(r));
}

SensorMisfits RodFit::MisfitsAt(const RodParameters& x,
                                const Eigen::Matrix<double, 9, 9>& covariance) const {
  SensorMisfits misfits;
  Residuals unused;
  if (!(*this)(x.data(), unused.data(), nullptr)) return misfits;
  for (std::size_t i = 0; i < misfits.size(); ++i) {
    const SensorRows& rows = sensor_rows_[i];
    if (rows.count > 0) misfits[i] = {FallWithout(rows, covariance), rows.count};
  }
  return misfits;
}

}  // namespace flextip
