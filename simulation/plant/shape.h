// One equilibrium of the plant: the shaft's shape and its loads.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "core/pose.h"
#include "simulation/plant/shaft_curve.h"

namespace flextip::simulation {

enum class PlantStatus {
  kOk,
  kBadInput,      ///< not finite, or a length or stiffness that is not positive
  kUnreachable,   ///< the port is at or beyond the shaft's length, or on the wrist
  kNotConverged,  ///< no equilibrium found, not even with the load applied in small steps
};
const char* Name(PlantStatus status);

/// Everything in R and SI units. Forces act on the shaft; port + wrist + tip + weight = 0, with
/// whatever else acts on it (second contact, load and tissue on the part beyond the port).
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

  // Changed by effects (simulation/plant/effects.h).
  /// The wrist by the encoders; the true wrist is T_RW().p.
  Eigen::Vector3d p_RW_measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();     ///< true centre of the port
  Eigen::Vector3d t_port = Eigen::Vector3d::UnitX();  ///< the shaft's tangent there
  double friction_N = 0.0;                            ///< along t_port, part of f_port_N
  bool slips = false;                                 ///< the port's friction is at its bound
  Eigen::Vector3d port_couple_Nm = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_contact_N = Eigen::Vector3d::Zero();  ///< of the second contact
  Eigen::Vector3d tip_yield_m = Eigen::Vector3d::Zero();  ///< of E from the shaft's end

  bool IsUsable() const { return status == PlantStatus::kOk; }

  /// Returns a place on the shaft (m, in R) at `s_m` from the wrist (0 to length_m), by cubic
  /// interpolation of the chain within the part before or behind the port. Needs IsUsable().
  Eigen::Vector3d Position(double s_m) const;
  Eigen::Vector3d Tangent(double s_m) const;  ///< unit
  /// Returns the internal moment of the part beyond on the part before (Nm).
  Eigen::Vector3d Moment(double s_m) const;
  /// Returns the wrist's frame carried along the shaft, twisted by the torsion alone; x is the
  /// tangent.
  Pose Frame(double s_m) const;

  /// Returns the true wrist frame: x along the shaft; R's axes turned without twist from x to the
  /// tangent, after a turn by the roll angle about x.
  Pose T_RW() const { return Frame(0.0); }
  /// Returns the tip: the end of the shaft, and its yield there.
  Pose T_RE() const {
    const Pose end = Frame(length_m);
    return {end.R, end.p + tip_yield_m};
  }
  ShaftCurve Curve() const;

 private:
  friend class Plant;
  struct Part {  // the chain before or behind the port
    int first = 0, first_moment = 0, links = 0;
    double s_begin = 0.0, h = 0.0;
  };
  Part PartAt(double s_m) const;

  Part parts_[2];
  std::vector<Eigen::Vector3d> nodes_;       // links + 1 positions
  std::vector<Eigen::Vector3d> moments_;     // at the nodes, the port's twice
  std::vector<Eigen::Vector3d> directions_;  // of the links
  std::vector<Eigen::Matrix3d> frames_;      // at the links' middles
  std::vector<double> twists_1_m_;           // of the links; empty: none
};

}  // namespace flextip::simulation
