// One port for several samples, each with its own wrist and tip force: the least squares behind
// window_estimator.h. Private to estimation.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/linear_algebra.h"
#include "estimation/rod_fit.h"

namespace flextip {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The wrist's place and the force, in RodParameters' units: wrist, force.
struct WindowSample {
  Measurements measurements;
  ShaftProblem shaft;
  RodPrior prior;  ///< its port is where the port would be without shift; sd not used
  Vector6d own = Vector6d::Zero();  ///< wrist (m), force in units of EI / L^2
  ShaftRod solver;
  long number = 0;  ///< of its update: the larger the newer
};

/// A fixed number of samples and the shift of the port that fits them all. Memory is reserved once.
class WindowPort {
 public:
  WindowPort(int samples, double prior_m, bool use_positions);

  /// Adds a sample and, where there is no room, drops the older of the two whose wrists are nearest
  /// each other: the rest stays spread.
  void Add(const WindowSample& sample);

  /// Fits by Gauss-Newton over the shift and every sample's own unknowns, which are eliminated
  /// sample by sample (Schur complement). Makes at most four evaluations of every sample. Halves a
  /// step that makes things worse; drops a sample without an equilibrium. Returns false where no
  /// sample is left.
  bool Refine();

  const Eigen::Vector3d& Shift() const { return shift_m_; }
  /// Returns the covariance of the shift (m^2).
  const Eigen::Matrix3d& Covariance() const { return covariance_m2_; }
  int Size() const { return size_; }
  double Chi2() const { return cost_; }
  void Reset();
  void VisitState(StateText& state);

 private:
  /// A sample's share, linearised.
  struct Part {
    Llt<6> own;                         // J_o^T J_o
    Eigen::Matrix<double, 6, 3> mixed;  // J_o^T J_port
    Vector6d gradient;                  // J_o^T r
    Vector6d before, step;              // of the sample's own unknowns
  };
  struct Sum {
    double cost = 0.0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  };

  bool Linearise(WindowSample& sample, Part& part, Sum& sum) const;
  bool LineariseAll(Sum& sum);
  void DropUnsolvable();
  void ProposeStep(const Sum& sum);
  void MoveAlong(double fraction);
  void Remove(int index);

  int capacity_;
  double prior_m_;
  bool use_positions_;
  int size_ = 0;
  std::vector<WindowSample> samples_;
  std::vector<Part> parts_;
  Eigen::Vector3d shift_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_before_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_step_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2_;
  double cost_ = 0.0;
};

}  // namespace flextip
