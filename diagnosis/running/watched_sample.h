// A moment's sensors against the instrument as it is, as rows of unit covariance with derivatives
// by all that is watched.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "diagnosis/model/geometry.h"
#include "diagnosis/replay/sensor_prediction.h"
#include "diagnosis/running/information.h"
#include "diagnosis/running/watched_parameters.h"
#include "estimation/watch/instrument_watch.h"

namespace flextip::diagnosis::running {

/// Solves the rod once a moment. Fixed size; allocates nothing.
class SampleWatch {
 public:
  /// Takes instrument, port and gravity from `base`.
  explicit SampleWatch(const Recording& base);

  const SampleSet& Set() const { return set_; }

  /// Fills `rows`, all but where the port goes. Returns false where nothing can be said: no
  /// equilibrium, too few sensors, or a force that jumps. `sampled` says which of em0, em1, strain
  /// and load are new.
  bool Whiten(const WatchedMoment& moment, const std::array<bool, 4>& sampled,
              WatchedParameters& parameters, WatchedRows& rows);

 private:
  using Matrix = Eigen::Matrix<double, kRows, kRows>;
  using ByThree = Eigen::Matrix<double, kRows, 3>;

  void SetSample(const WatchedMoment& moment, const std::array<bool, 4>& sampled);
  void SetInputs(const ShaftChange& change);
  void FindRate(double t_s, const Geometry& at);
  Matrix OwnCovariance(const Measurements& z) const;
  static Eigen::Vector3d ForceStep(const Matrix& known, const ByThree& by_force,
                                   const Eigen::Matrix3d& root,
                                   const Eigen::Matrix<double, kRows, 1>& e);
  bool FollowForce(const Eigen::Vector3d& along, const Eigen::Vector3d& step_N);

  SampleSet set_;
  double force_unit_N_;
  EffectRodSolver solver_;
  SampleInputs inputs_ = SampleInputs::Zero();
  Eigen::Vector3d f_tip_N_ = Eigen::Vector3d::Zero();  // by the moments before
  double last_t_s_ = -1e9;
  TimeNs start_ns_ = 0;
  bool knows_place_ = false, has_load_ = false;
  // The last geometries, for the rate of change: the newest first.
  struct Timed {
    double t_s = 0.0;
    Geometry at = Geometry::Zero();
  };
  std::array<Timed, 4> last_;
  int known_ = 0;
  struct Place {
    bool ok = false;
    Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
    double s_port_m = 0.0, ds_port_dfriction_m = 0.0;
  };
  Place before_;  // at the last moment
  Geometry rate_ = Geometry::Zero();
};

}  // namespace flextip::diagnosis::running
