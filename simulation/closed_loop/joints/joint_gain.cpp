#include "simulation/closed_loop/joints/joint_gain.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "arms/feed_forward/joint_model.h"
#include "core/error.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::simulation {
namespace {

using arms::ArmModel;
using diagnosis::EffectFit;

constexpr double kStandIn_kg = 0.3, kStandIn_m = 0.05;
constexpr double kLeast_rad = 0.05, kMost_rad = 0.4, kLeast_m = 0.005, kMost_m = 0.04;
constexpr double kUsualLag_s = 1e-3;

bool Has(const std::vector<EffectFit>& fits, const std::string& effect) {
  return std::any_of(fits.begin(), fits.end(),
                     [&](const EffectFit& fit) { return fit.effect == effect; });
}

std::vector<double> ListIn(const ArmModel& model, const std::string& effect,
                           const std::string& name) {
  for (const auto* fits : {&model.effects, &model.within_tolerance})
    for (const EffectFit& fit : *fits)
      for (const auto& p : fit.parameters)
        if (fit.effect == effect && p.name == name) return p.value;
  return {};
}

Eigen::VectorXd VectorOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()))
      .cwiseMax(0.0);
}

/// 1 over a compliance, at most as stiff as the plant's own `drive` says.
Eigen::VectorXd StiffnessBy(const JointVector& compliance, const JointModel& joints,
                            double JointDrive::*drive) {
  Eigen::VectorXd stiffness(joints.size);
  for (int i = 0; i < joints.size; ++i) {
    const bool turns = joints.turns[std::size_t(i)];
    stiffness[i] = StiffnessOf(compliance[i], StiffDrive(turns).*drive);
  }
  return stiffness;
}

ArmFaults FaultsOf(const arms::ArmData& data, const ArmModel& model, const JointModel& joints,
                   std::vector<std::string>& notes) {
  const int n = joints.size;
  ArmFaults faults;
  faults.encoder_offset = joints.offset;
  faults.encoder_scale = joints.scale.array() - 1.0;
  faults.routing = Eigen::MatrixXd::Identity(n, n) + Eigen::MatrixXd(joints.coupling);
  if (Has(model.effects, "joint_backlash")) {
    faults.play = joints.play.diagonal().cwiseAbs();
    notes.emplace_back(
        "joint_backlash: the simulated arm has it without gravity and with friction of "
        "the links, or it would hang on one side of its play");
    JointMatrix drag = joints.play;
    drag.diagonal().setZero();
    if (drag.cwiseAbs().maxCoeff() > 0.1 * joints.play.diagonal().cwiseAbs().maxCoeff())
      notes.emplace_back(
          "joint_backlash.drag: the simulated arm does not have it, and the "
          "feed-forward is not asked for it");
  }
  faults.command_delay_s = joints.delay_s;
  faults.servo_stiffness = StiffnessBy(joints.droop, joints, &JointDrive::servo_stiffness);
  faults.servo_damping =
      faults.servo_stiffness.cwiseProduct(Eigen::VectorXd(joints.lag_s.cwiseMax(kUsualLag_s)));
  faults.servo_holds_gravity = !Has(model.effects, "servo_droop");
  faults.cable_stiffness = StiffnessBy(joints.compliance, joints, &JointDrive::cable_stiffness);
  if (Has(model.effects, "joint_friction")) {
    faults.motor_coulomb = VectorOf(ListIn(model, "joint_friction", "coulomb"));
    faults.motor_viscous = VectorOf(ListIn(model, "joint_friction", "viscous"));
  }
  for (const EffectFit& fit : model.effects) {
    if (fit.effect != "payload") continue;
    const ArmModel one{{fit}, {}, {}, {}};
    const auto place = std::size_t(ListIn(one, "payload", "place").at(0)) - 1;
    if (place >= data.arm.payload_places.size()) continue;
    const PayloadPlace& named = data.arm.payload_places[place];
    if (named.keeps_orientation_of > 0) {
      notes.emplace_back(
          "payload: on a bar of a parallelogram, which the simulated arm has none of");
      continue;
    }
    faults.payload.push_back({named.link - 1, ListIn(one, "payload", "mass_kg").at(0), named.p_m});
  }
  return faults;
}

/// About the middle of what was recorded, half as far as it went.
SineMotion MotionAbout(const arms::ArmData& data) {
  const Eigen::MatrixXd& q = data.joints.values;
  SineMotion motion;
  motion.seed = 5;
  const Eigen::VectorXd low = q.colwise().minCoeff(), high = q.colwise().maxCoeff();
  motion.centre = 0.5 * (low + high);
  motion.size = 0.5 * (high - low);
  for (int i = 0; i < data.Size(); ++i)
    motion.size[i] = std::clamp(motion.size[i], data.TypicalOf(i, kLeast_rad, kLeast_m),
                                data.TypicalOf(i, kMost_rad, kMost_m));
  return motion;
}

/// Whether a command of the joints can take away any of what was found.
bool CanCorrect(const ArmModel& model, const std::vector<std::string>& not_corrected) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const EffectFit& fit) {
    return std::none_of(not_corrected.begin(), not_corrected.end(), [&](const std::string& line) {
      return line.starts_with(fit.effect + ":");
    });
  });
}

}  // namespace

JointGain MeasureJointGain(const arms::ArmData& data, const ArmModel& model) {
  JointGain gain;
  if (data.arm.convention == ArmConvention::kUrdf) {
    gain.notes.emplace_back(
        "the simulated arm is made of Denavit and Hartenberg's numbers: none for "
        "an arm from a URDF");
    return gain;
  }
  Arm arm = data.arm;
  ArmModel known = model;
  if (arm.links.empty()) {
    arm.links.assign(std::size_t(arm.Size()), {kStandIn_kg, {kStandIn_m, 0.0, 0.0}});
    std::erase_if(known.nuisances, [](const EffectFit& fit) { return fit.effect == "masses"; });
    gain.notes.push_back(fmt::format(
        "masses: the arm's file states none; the simulated arm and the feed-forward have {} kg a "
        "link",
        kStandIn_kg));
  }
  const bool has_play = Has(model.effects, "joint_backlash");
  const Eigen::Vector3d gravity_m_s2 =
      has_play ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : data.gravity_m_s2;
  arms::CommandModel command = CommandModelOf(arm, known, gravity_m_s2);
  command.joints.effort_at_rest = false;  // the plant's masses are the file's, and known
  gain.notes.insert(gain.notes.end(), command.not_corrected.begin(), command.not_corrected.end());
  if (!CanCorrect(model, command.not_corrected)) return gain;
  const ArmFaults faults = FaultsOf(data, model, command.joints, gain.notes);
  JointLoopSetup setup;
  setup.plant = PlantOf(arm, faults);
  setup.plant.gravity_m_s2 = gravity_m_s2;
  setup.encoder_offset = faults.encoder_offset;
  setup.encoder_scale = faults.encoder_scale;
  setup.motion = MotionOf(MotionAbout(data));
  if (arm.T_LK) setup.T_LK = *arm.T_LK;
  JointLoopSetup with = setup;
  with.model = command.joints;
  // What one joint's play drags along is not in the plant.
  with.model->play = JointMatrix(command.joints.play.diagonal().asDiagonal());
  bool base_ran = true, extended_ran = true;
  const auto run = [](const JointLoopSetup& one, JointLoopResult& result, bool& ran) {
    try {
      result = RunJointLoop(one);
    } catch (const std::runtime_error&) {
      ran = false;
    }
  };
  tbb::parallel_invoke([&] { run(setup, gain.base, base_ran); },
                       [&] { run(with, gain.extended, extended_ran); });
  gain.ran = base_ran && extended_ran;
  if (!gain.ran) gain.notes.emplace_back("the simulated arm did not stay finite");
  return gain;
}

}  // namespace flextip::simulation
