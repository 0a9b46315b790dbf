// Soft silicone in a dish, as the tip of a thin rod meets it: it gives way elastically, is cut when
// pushed too far, drags the tip sideways, and stays weaker where it was cut. A tip load with a
// memory, for the plant (thesis 5.2.6).
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "simulation/tissue/tip_load.h"

namespace flextip::simulation {

/// Everything in R. `SiliconeOf` gives the constants of a material.
struct SoftCylinderSetup {
  Eigen::Vector3d p_surface = Eigen::Vector3d::Zero();  ///< centre of the surface
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitX();   ///< unit, out of the silicone
  double radius_m = 0.045;
  double axial_stiffness_N_m = 0.0;     ///< indentation by the rod's end
  double puncture_N = 0.0;              ///< axial force at which the end cuts its way
  double lateral_stiffness_N_m2 = 0.0;  ///< sideways, per depth
  double ploughing_N_m = 0.0;           ///< sideways force at which it tears, per depth
  double ploughing_when_cut_N_m = 0.0;  ///< the same where it was cut before
  double rod_diameter_m = 0.0;          ///< width of the cut
  double onset_m = 5e-4;                ///< depth over which forces set in smoothly
};

/// What a soft, tacky elastomer does to a blunt rod, from four figures of the material.
struct Silicone {
  double elastic_modulus_Pa = 3400.0;  ///< thesis 5.2.6
  double poisson = 0.49;
  double fracture_energy_J_m2 = 10.0;  ///< of soft silicone gels: single to tens of J/m^2
  double friction = 1.0;               ///< tacky
  double tearing_stress_moduli = 2.0;  ///< stress at which it tears ahead of the rod, in moduli
};

/// Forces by the mechanics of indentation and of wire cutting; README.md has the formulas. `scale`
/// multiplies all forces.
SoftCylinderSetup SiliconeOf(const Silicone& material, double rod_diameter_m, double scale = 1.0);

/// Force law at an instant, and the memory that is moved on once an equilibrium was found.
class SoftCylinder {
 public:
  explicit SoftCylinder(const SoftCylinderSetup& setup);

  /// The force on a tip at `p_tip` (m, in R) with the memory as it is; continuous, with its
  /// derivative.
  LinearTipForce At(const Eigen::Vector3d& p_tip) const;
  /// The tip has come to `p_tip`: what gave way stays so, what was cut stays cut.
  void MoveTo(const Eigen::Vector3d& p_tip);

  /// m below the surface; negative outside.
  double Depth(const Eigen::Vector3d& p_tip) const;
  /// How deep it was cut at the place nearest to `p_tip`, m; 0 outside the dish.
  double CutDepth(const Eigen::Vector3d& p_tip) const;
  /// Part of the surface within `radius_m` of the centre that was cut, 0 to 1.
  double CutPart(double radius_m) const;

  const SoftCylinderSetup& Setup() const { return setup_; }

 private:
  Eigen::Vector2d Across(const Eigen::Vector3d& p_tip) const;
  /// Of the cell there in cut_m_; empty beyond the grid.
  std::optional<std::size_t> CellAt(const Eigen::Vector2d& at) const;
  double PloughingAhead(const Eigen::Vector2d& at, double depth) const;
  void Cut(const Eigen::Vector2d& at, double depth);

  SoftCylinderSetup setup_;
  Eigen::Matrix<double, 3, 2> across_;  // two axes along the surface
  int cells_ = 0;                       // along one side of the grid
  std::vector<double> cut_m_;           // depth to which each cell is cut
  bool inside_ = false;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero();  // where the sideways spring is at rest
  Eigen::Vector2d last_ = Eigen::Vector2d::Zero();    // where the tip was
  double floor_m_ = 0.0;                              // depth at which the axial one is
  double ploughing_N_m_ = 0.0;                        // now, per depth
};

}  // namespace flextip::simulation
