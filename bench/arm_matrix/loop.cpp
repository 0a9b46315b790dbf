#include "bench/arm_matrix/loop.h"

#include "arms/feed_forward/joint_model.h"
#include "simulation/closed_loop/joints/joint_loop.h"

namespace flextip::bench {

ArmLoop RunArmLoop(const HiddenArm& hidden, const arms::ArmModel& model) {
  const Arm arm = simulation::SmallArm();
  simulation::JointLoopSetup setup;
  setup.plant = PlantOf(arm, hidden.faults);
  setup.encoder_offset = hidden.faults.encoder_offset;
  setup.encoder_scale = hidden.faults.encoder_scale;
  setup.motion = simulation::MotionOf({.centre = Eigen::Vector3d(0.2, 0.2, 0.1),
                                       .size = Eigen::Vector3d(0.3, 0.3, 0.03),
                                       .seed = hidden.motion.seed + 1});
  setup.T_LK = *arm.T_LK;
  const simulation::JointLoopResult before = RunJointLoop(setup);
  setup.model = CommandModelOf(arm, model, setup.plant.gravity_m_s2).joints;
  const simulation::JointLoopResult after = RunJointLoop(setup);
  const auto list = [](const Eigen::VectorXd& v) {
    return std::vector<double>(v.data(), v.data() + v.size());
  };
  return {list(before.rms), list(after.rms), before.tip_rms_m, after.tip_rms_m};
}

}  // namespace flextip::bench
