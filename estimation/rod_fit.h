// The measurements of one instant as residuals of the rod, whitened, with their derivatives.
// Private to estimation.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "estimation/measurements.h"
#include "estimation/shaft_rod.h"

namespace flextip {

/// Parameters: wrist position (m), port position (m), tip force in units of EI / L^2.
using RodParameters = Eigen::Matrix<double, 9, 1>;

/// Enough rows for every sensor at once; the rows not used are zero.
inline constexpr int kMaxRodResiduals = 32;

struct RodPrior {
  RodParameters mean = RodParameters::Zero();
  RodParameters sd = RodParameters::Ones();
  /// W with W^T W the information on the port, in place of its `sd`.
  std::optional<Eigen::Matrix3d> port_whitening;
};

/// The cost function of one instant, in the form ceres::TinySolver takes.
class RodFit {
 public:
  using Scalar = double;
  // NOLINTNEXTLINE(readability-identifier-naming): the names are Ceres'
  enum { NUM_RESIDUALS = kMaxRodResiduals, NUM_PARAMETERS = 9 };
  using Residuals = Eigen::Matrix<double, NUM_RESIDUALS, 1>;
  using Jacobian = Eigen::Matrix<double, NUM_RESIDUALS, NUM_PARAMETERS>;

  /// Takes length, stiffness, weight and effects from `shaft`. Without `use_positions` the places
  /// of tip and EM sensor are left out. The references must outlive the object.
  RodFit(const ShaftProblem& shaft, const Measurements& measurements, const RodPrior& prior,
         bool use_positions, ShaftRod& solver);

  /// Narrows the prior of the force to `sd`, in units of EI / L^2.
  void LimitForce(double sd) {
    prior_.sd.tail<3>().setConstant(sd);
    known_ = false;
  }

  /// Returns false where the rod has no equilibrium. `jacobian` (column-major) may be null.
  bool operator()(const double* parameters, double* residuals, double* jacobian) const;

  /// Returns the rod at `parameters`; the last one again where they are the same.
  const ShaftRodState& RodAt(const RodParameters& parameters) const;

  /// Returns the number of scalar measurements (without the priors) that the last call used.
  int MeasurementCount() const { return rows_ - NUM_PARAMETERS; }

  /// Returns each sensor against all others, where the least squares are and leave `covariance`.
  SensorMisfits MisfitsAt(const RodParameters& x,
                          const Eigen::Matrix<double, 9, 9>& covariance) const;

  ShaftProblem ProblemAt(const RodParameters& parameters) const;
  const RodParameters& PriorMean() const { return prior_.mean; }
  double ForceUnit() const { return force_unit_; }

 private:
  /// Rows that belong to one sensor.
  struct SensorRows {
    int from = 0, count = 0;
  };
  double FallWithout(const SensorRows& rows, const Eigen::Matrix<double, 9, 9>& covariance) const;
  void AddPosition(const Eigen::Vector3d& measured, const Eigen::Matrix3d& whiten,
                   const Eigen::Vector3d& p, const RodDerivative& dp) const;
  void AddDirection(const Eigen::Vector3d& measured, double noise_rad, const Eigen::Vector3d& t,
                    const RodDerivative& dt) const;
  void AddStrain(const ShaftRodState& rod) const;
  void AddSensors(const ShaftRodState& rod, const RodParameters& x) const;
  void AddPrior(const RodParameters& parameters) const;

  ShaftProblem shaft_;
  const Measurements& measurements_;
  RodPrior prior_;
  bool use_positions_;
  ShaftRod& solver_;
  double force_unit_;
  std::array<RodStation, kMaxShaftStations> stations_;  // the strain's two, then the EM sensor's
  std::size_t station_count_ = 0;
  int em_station_ = -1;
  mutable int rows_ = 0;
  mutable std::array<SensorRows, kComparedSensors> sensor_rows_;
  mutable bool known_ = false, filled_ = false;  // the rod at x_, and the residuals there
  mutable RodParameters x_;
  mutable ShaftRodState rod_;
  mutable Residuals residuals_;
  mutable Jacobian jacobian_;
};

}  // namespace flextip
