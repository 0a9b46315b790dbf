#include "simulation/plant/memory.h"

namespace flextip::simulation {

Eigen::Vector3d PlayOperator::Update(const Eigen::Vector3d& driver, double width) {
  if (!moved_) moved_ = driver;
  const Eigen::Vector3d gap = Eigen::Vector3d::Constant(0.5 * width);
  moved_ = moved_->cwiseMax(driver - gap).cwiseMin(driver + gap);
  return *moved_;
}

}  // namespace flextip::simulation
