// The plant's memory from equilibrium to equilibrium.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace flextip::simulation {

/// Play between two places, per axis: `moved` follows `driver` once the gap of `width` is used up.
/// The first time they are together.
class PlayOperator {
 public:
  Eigen::Vector3d Update(const Eigen::Vector3d& driver, double width);

 private:
  std::optional<Eigen::Vector3d> moved_;
};

/// Where friction at the port holds: in units of the shaft's length.
struct FrictionMemory {
  double anchor = 0.0;  ///< s of the port where the bristles are relaxed
  double chord = 0.0;   ///< from wrist to port, at the last equilibrium
};

/// One place of the shaft in the tissue, its last position in R and the force per length then.
struct TissueElement {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_N_m = Eigen::Vector3d::Zero();
};

struct PlantMemory {
  std::optional<double> t_s;                  ///< of the last equilibrium
  std::optional<Eigen::Vector3d> p_RW_first;  ///< as measured
  PlayOperator backlash;
  std::optional<FrictionMemory> friction;
  std::vector<TissueElement> tissue;  ///< empty before the first
};

}  // namespace flextip::simulation
