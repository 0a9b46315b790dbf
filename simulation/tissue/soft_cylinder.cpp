#include "simulation/tissue/soft_cylinder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/check.h"

namespace flextip::simulation {
namespace {

constexpr double kCell_m = 5e-4;
constexpr double kCorner = 0.2;  // half width of the rounded corner between elastic and torn

/// Elastic, then constant: u up to 1 - w, 1 from 1 + w, a parabola between them.
struct Yielding {
  double value = 0.0, slope = 0.0;
};

Yielding YieldingAt(double u) {
  if (u <= 1.0 - kCorner) return {u, 1.0};
  if (u >= 1.0 + kCorner) return {1.0, 0.0};
  const double left = 1.0 + kCorner - u;
  return {1.0 - left * left / (4.0 * kCorner), left / (2.0 * kCorner)};
}

/// A depth with a smooth onset: 0 above the surface.
struct Ramp {
  double value = 0.0, slope = 0.0;
};

Ramp RampAt(double depth, double onset) {
  if (depth <= 0.0) return {};
  if (depth < onset) return {0.5 * depth * depth / onset, depth / onset};
  return {depth - 0.5 * onset, 1.0};
}

}  // namespace

SoftCylinderSetup SiliconeOf(const Silicone& material, double rod_diameter_m, double scale) {
  const double radius = 0.5 * rod_diameter_m;
  const double plane = 1.0 - material.poisson * material.poisson;
  const double line =
      material.fracture_energy_J_m2 + (1.0 + material.friction) * material.tearing_stress_moduli *
                                          material.elastic_modulus_Pa * rod_diameter_m;
  // A cut that is there already saves the fracture energy; the sides still have to be held apart.
  const double reopened = 0.5 * (line - material.fracture_energy_J_m2);
  const double shear = material.elastic_modulus_Pa / (2.0 * (1.0 + material.poisson));
  constexpr double kReach = 10.0;  // sideways strain ends at about this many rod radii
  SoftCylinderSetup setup;
  setup.rod_diameter_m = rod_diameter_m;
  setup.axial_stiffness_N_m = scale * 2.0 * radius * material.elastic_modulus_Pa / plane;
  // A blunt end that punctures: the pressure of tearing on its face, and a crack around it.
  setup.puncture_N = scale * std::numbers::pi *
                     (radius * radius * (1.0 + material.friction) * material.tearing_stress_moduli *
                          material.elastic_modulus_Pa +
                      2.0 * radius * material.fracture_energy_J_m2);
  setup.lateral_stiffness_N_m2 = scale * 4.0 * std::numbers::pi * shear / (std::log(kReach) + 0.5);
  setup.ploughing_N_m = scale * line;
  setup.ploughing_when_cut_N_m = scale * reopened;
  return setup;
}

SoftCylinder::SoftCylinder(const SoftCylinderSetup& setup) : setup_(setup) {
  FLEXTIP_CHECK(setup.radius_m > 0.0 && setup.onset_m > 0.0 && setup.rod_diameter_m > 0.0,
                "positive lengths");
  const Eigen::Vector3d& n = setup_.normal;
  across_.col(0) = n.cross(std::abs(n.z()) < 0.9 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                                 : Eigen::Vector3d(Eigen::Vector3d::UnitX()))
                       .normalized();
  across_.col(1) = n.cross(across_.col(0));
  cells_ = 2 * static_cast<int>(std::ceil(setup.radius_m / kCell_m));
  cut_m_.assign(static_cast<std::size_t>(cells_) * cells_, 0.0);
  ploughing_N_m_ = setup_.ploughing_N_m;
}

double SoftCylinder::Depth(const Eigen::Vector3d& p_tip) const {
  return -setup_.normal.dot(p_tip - setup_.p_surface);
}

Eigen::Vector2d SoftCylinder::Across(const Eigen::Vector3d& p_tip) const {
  return across_.transpose() * (p_tip - setup_.p_surface);
}

LinearTipForce SoftCylinder::At(const Eigen::Vector3d& p_tip) const {
  const Eigen::Vector3d& n = setup_.normal;
  const double depth = Depth(p_tip);
  const Ramp ramp = RampAt(depth, setup_.onset_m);
  if (ramp.value <= 0.0) return {};
  LinearTipForce force;
  // Along the axis: from where the end has cut to.
  const Ramp dent = RampAt(depth - floor_m_, setup_.onset_m);
  const double axial = setup_.puncture_N;
  const Yielding pushed = YieldingAt(setup_.axial_stiffness_N_m * dent.value / axial);
  force.f_N = axial * pushed.value * n;
  force.df_dp_N_m = -setup_.axial_stiffness_N_m * pushed.slope * dent.slope * n * n.transpose();
  // Sideways: stiffness and strength both grow with the depth.
  const Eigen::Vector2d stretch = Across(p_tip) - (inside_ ? anchor_ : Across(p_tip));
  const double size = stretch.norm();
  const double most = ploughing_N_m_, per_m = setup_.lateral_stiffness_N_m2 / most;
  const Yielding dragged = YieldingAt(per_m * size);
  const double secant = size > 0.0 ? dragged.value / size : per_m;
  const Eigen::Vector2d along = size > 0.0 ? Eigen::Vector2d(stretch / size) : stretch;
  const Eigen::Matrix2d slope = secant * Eigen::Matrix2d::Identity() +
                                (per_m * dragged.slope - secant) * along * along.transpose();
  const Eigen::Vector3d pull = across_ * (-most * secant * stretch);
  force.f_N += ramp.value * pull;
  if (inside_) {
    force.df_dp_N_m += -most * ramp.value * across_ * slope * across_.transpose() -
                       ramp.slope * pull * n.transpose();
  }
  return force;
}

void SoftCylinder::MoveTo(const Eigen::Vector3d& p_tip) {
  const double depth = Depth(p_tip);
  const Eigen::Vector2d at = Across(p_tip);
  if (depth <= 0.0) {
    inside_ = false;
    return;
  }
  if (!inside_) {
    inside_ = true;
    anchor_ = at;
    floor_m_ = CutDepth(p_tip);
    last_ = at;
    ploughing_N_m_ = setup_.ploughing_N_m;
  }
  // The end: beyond the puncture it has cut; drawn back, the dent is gone.
  const double dent =
      (1.0 + kCorner) * setup_.puncture_N / setup_.axial_stiffness_N_m + 0.5 * setup_.onset_m;
  floor_m_ = std::clamp(floor_m_, depth - dent, depth);
  // Sideways: beyond the tearing force the rest position is dragged along.
  const Eigen::Vector2d stretch = at - anchor_;
  const double size = stretch.norm();
  const double longest = (1.0 + kCorner) * ploughing_N_m_ / setup_.lateral_stiffness_N_m2;
  if (size > longest) anchor_ = at - longest / size * stretch;
  const bool tears = size > (1.0 - kCorner) / (1.0 + kCorner) * longest;
  if (tears || floor_m_ > 0.0) Cut(at, tears ? depth : floor_m_);
  // The rod is as wide as it is: the force changes over its diameter, not at once.
  const double travel = std::min(1.0, (at - last_).norm() / setup_.rod_diameter_m);
  ploughing_N_m_ += travel * (PloughingAhead(at, depth) - ploughing_N_m_);
  last_ = at;
}

/// What tearing on takes per depth, from the material just before the rod.
double SoftCylinder::PloughingAhead(const Eigen::Vector2d& at, double depth) const {
  const Eigen::Vector2d stretch = at - anchor_;
  const double size = stretch.norm();
  if (size == 0.0) return ploughing_N_m_;
  const auto cell = CellAt(at + (0.5 * setup_.rod_diameter_m + kCell_m) / size * stretch);
  const double part = cell ? std::min(1.0, cut_m_[*cell] / depth) : 0.0;
  return part * setup_.ploughing_when_cut_N_m + (1.0 - part) * setup_.ploughing_N_m;
}

void SoftCylinder::Cut(const Eigen::Vector2d& at, double depth) {
  const double radius = 0.5 * setup_.rod_diameter_m;
  for (double x = -radius; x <= radius; x += kCell_m) {
    for (double y = -radius; y <= radius; y += kCell_m) {
      if (x * x + y * y > radius * radius) continue;
      const auto cell = CellAt(at + Eigen::Vector2d(x, y));
      if (cell) cut_m_[*cell] = std::max(cut_m_[*cell], depth);
    }
  }
}

std::optional<std::size_t> SoftCylinder::CellAt(const Eigen::Vector2d& at) const {
  const Eigen::Vector2i cell = (at / kCell_m).array().floor().cast<int>() + cells_ / 2;
  if ((cell.array() < 0).any() || (cell.array() >= cells_).any()) return {};
  return static_cast<std::size_t>(cell.x()) * cells_ + cell.y();
}

double SoftCylinder::CutDepth(const Eigen::Vector3d& p_tip) const {
  const auto cell = CellAt(Across(p_tip));
  return cell ? cut_m_[*cell] : 0.0;
}

double SoftCylinder::CutPart(double radius_m) const {
  int cut = 0, all = 0;
  for (int i = 0; i < cells_; ++i) {
    for (int j = 0; j < cells_; ++j) {
      const Eigen::Vector2d at((i + 0.5 - 0.5 * cells_) * kCell_m,
                               (j + 0.5 - 0.5 * cells_) * kCell_m);
      if (at.norm() > radius_m) continue;
      ++all;
      cut += cut_m_[static_cast<std::size_t>(i) * cells_ + j] > 0.0;
    }
  }
  return all > 0 ? static_cast<double>(cut) / all : 0.0;
}

}  // namespace flextip::simulation
