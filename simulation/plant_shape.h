// One equilibrium of the plant: the shaft's shape and what acts on it.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "core/pose.h"
#include "simulation/shaft_curve.h"

namespace flextip {

enum class PlantStatus {
  kOk,
  kBadInput,      ///< not finite, or a length or stiffness that is not positive
  kUnreachable,   ///< the port is at or beyond the shaft's length, or on the wrist
  kNotConverged,  ///< no equilibrium found, not even with the load applied in small steps
};
const char* Name(PlantStatus status);

/// Everything in R and SI units. Forces act on the shaft; port + wrist + tip + weight = 0.
class PlantShape {
 public:
  PlantStatus status = PlantStatus::kNotConverged;
  std::string message = "not solved";  ///< why, where the status is not kOk
  int iterations = 0;                  ///< Newton steps
  double length_m = 0.0;
  double diameter_m = 0.0;
  double s_port_m = 0.0;  ///< of the port, from the wrist along the shaft
  Eigen::Vector3d f_port_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_wrist_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();

  bool IsUsable() const { return status == PlantStatus::kOk; }

  /// The shaft at `s_m` from the wrist (0 to length_m), by cubic interpolation of the chain within
  /// the part before or behind the port. Need IsUsable().
  Eigen::Vector3d Position(double s_m) const;
  Eigen::Vector3d Tangent(double s_m) const;  ///< unit
  /// Internal moment of the part beyond on the part before (Nm).
  Eigen::Vector3d Moment(double s_m) const;
  /// The wrist's frame carried along the shaft without twist; x is the tangent.
  Pose Frame(double s_m) const;

  /// The wrist frame: x along the shaft; R's axes turned without twist from x to the tangent, after
  /// a turn by the roll angle about x.
  Pose T_RW() const { return Frame(0.0); }
  Pose T_RE() const { return Frame(length_m); }
  ShaftCurve Curve() const;

 private:
  friend class Plant;
  struct Part {  // the chain before or behind the port
    int first = 0, links = 0;
    double s_begin = 0.0, h = 0.0;
  };
  Part PartAt(double s_m) const;

  Part parts_[2];
  std::vector<Eigen::Vector3d> nodes_;       // links + 1 positions
  std::vector<Eigen::Vector3d> moments_;     // at the nodes
  std::vector<Eigen::Vector3d> directions_;  // of the links
  std::vector<Eigen::Matrix3d> frames_;      // of the links
};

}  // namespace flextip
