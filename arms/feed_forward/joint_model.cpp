#include "arms/feed_forward/joint_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "arms/effects/effects.h"
#include "arms/model/dynamics.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;
using Fits = std::vector<EffectFit>;

constexpr double kMeasured = 0.3;  // of its tolerance a number's deviation is at most

bool Has(const Fits& fits, const std::string& effect) {
  return std::any_of(fits.begin(), fits.end(),
                     [&](const EffectFit& fit) { return fit.effect == effect; });
}

/// The list of that name, or `fallback` everywhere where the model has no such effect.
Eigen::VectorXd List(const Fits& fits, const std::string& effect, const std::string& name, int size,
                     double fallback) {
  for (const EffectFit& fit : fits) {
    if (fit.effect != effect) continue;
    const std::vector<double> values = ListOf(effect, ParametersOf(fit), name, size);
    return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
  }
  return Eigen::VectorXd::Constant(size, fallback);
}

/// What is within specification of a number behind the encoders (docs/effects.md); 0: of no such.
double ToleranceOf(const std::string& effect, bool turns) {
  if (effect == "joint_offset") return turns ? 5e-4 : 2e-4;
  if (effect == "joint_scale") return 5e-4;
  if (effect == "joint_coupling") return 1e-3;
  if (effect == "joint_compliance") return turns ? 2e-4 : 1e-5;
  return 0.0;
}

/// An effect within tolerance, behind the encoders without the numbers that the data hardly
/// measured: they may be a marker's place.
EffectFit WhatIsMeasured(EffectFit fit, const Arm& arm) {
  const auto n = std::size_t(arm.Size());
  for (auto& p : fit.parameters) {
    const double none = fit.effect == "joint_scale" ? 1.0 : 0.0;
    for (std::size_t i = 0; i < p.value.size() && i < p.sd.size(); ++i) {
      const std::size_t joint =
          p.value.size() == n ? i : std::size_t(OffDiagonal(int(n), int(i)).row);
      const double tolerance =
          ToleranceOf(fit.effect, arm.joints[joint % n].type == JointType::kRevolute);
      if (p.sd[i] > kMeasured * tolerance && tolerance > 0.0) p.value[i] = none;
    }
  }
  return fit;
}

JointMatrix Square(const Eigen::VectorXd& off_diagonal, int n) {
  JointMatrix matrix = JointMatrix::Zero(n, n);
  for (int m = 0; m < n * n - n; ++m) {
    const Entry entry = OffDiagonal(n, m);
    matrix(entry.row, entry.column) = off_diagonal[m];
  }
  return matrix;
}

/// Adds link numbers (dynamics.h) to the link of a joint.
void AddNumbers(const Eigen::VectorXd& numbers, EffortJoint& joint) {
  joint.mass_kg += numbers[0];
  joint.moment_kg_m += numbers.segment<3>(1);
  Eigen::Matrix3d inertia;
  inertia << numbers[4], numbers[5], numbers[6], numbers[5], numbers[7], numbers[8], numbers[6],
      numbers[8], numbers[9];
  joint.inertia_kg_m2 += inertia;
}

/// Hangs the payloads that were found; those on a bar go to `not_corrected`.
void AddPayloads(const Arm& arm, const Fits& fits, std::vector<EffortJoint>& joints,
                 std::vector<std::string>& not_corrected) {
  for (const EffectFit& fit : fits) {
    if (fit.effect != "payload") continue;
    const double mass_kg = List({fit}, "payload", "mass_kg", 1, 0.0)[0];
    const auto place = std::size_t(List({fit}, "payload", "place", 1, 0.0)[0]) - 1;
    ArmLink hung{mass_kg, Eigen::Vector3d::Zero()};
    int link = 0;
    if (arm.payload_places.empty() && place < arm.links.size()) {
      link = int(place) + 1;
      hung.com_m = arm.links[place].com_m;
    } else if (place < arm.payload_places.size()) {
      const PayloadPlace& named = arm.payload_places[place];
      if (named.keeps_orientation_of > 0) {
        not_corrected.emplace_back(
            "payload: on a bar of a parallelogram its effort is not expected");
        continue;
      }
      link = named.link;
      hung.com_m = named.p_m;
    }
    if (link < 1 || link > arm.Size()) {
      throw InputError(
          fmt::format("payload.place: found {}, which the arm does not have", place + 1));
    }
    AddNumbers(NumbersOf(hung), joints[std::size_t(link - 1)]);
  }
}

std::vector<EffortJoint> EffortJoints(const Arm& arm, const ArmModel& model, const Fits& given,
                                      std::vector<std::string>& not_corrected) {
  const int n = arm.Size();
  const bool moving = Has(model.nuisances, "masses");
  const Eigen::VectorXd numbers =
      List(model.nuisances, "masses", "link_numbers", kLinkNumbers * n, 0.0);
  const auto nuisance = [&](const char* name) {
    return List(model.nuisances, "masses", name, n, 0.0);
  };
  const Eigen::VectorXd motor = nuisance("motor_inertia"), spring = nuisance("spring"),
                        zero = nuisance("effort_zero"),
                        coulomb = List(given, "joint_friction", "coulomb", n, 0.0),
                        viscous = List(given, "joint_friction", "viscous", n, 0.0);
  std::vector<EffortJoint> joints;
  for (int i = 0; i < n; ++i) {
    const ArmJoint& named = arm.joints[std::size_t(i)];
    EffortJoint joint{.turns = named.type == JointType::kRevolute};
    joint.R_before = named.before.R;
    joint.p_before = named.before.p;
    joint.R_after = named.after.R;
    joint.p_after = named.after.p;
    joint.axis = named.axis;
    joint.zero = named.zero;
    if (!arm.links.empty()) AddNumbers(NumbersOf(arm.links[std::size_t(i)]), joint);
    if (moving) {
      AddNumbers(numbers.segment(kLinkNumbers * i, kLinkNumbers), joint);
      joint.motor_inertia = motor[i];
      joint.spring = spring[i];
      joint.effort_zero = zero[i];
      joint.coulomb = std::max(0.0, coulomb[i]);
      joint.viscous = std::max(0.0, viscous[i]);
    }
    joints.push_back(joint);
  }
  if (moving) AddPayloads(arm, given, joints, not_corrected);
  return joints;
}

/// Springs that draw joints back are a scale and a coupling to the feed-forward.
void TakeSprings(const ArmModel& model, JointModel& joints) {
  for (const EffectFit& fit : model.effects) {
    if (fit.effect != "joint_backlash") continue;
    const PlayHistory history = PlayHistoryOf(ParametersOf(fit), joints.size);
    if (history.carried.size() == 0) continue;
    const Eigen::MatrixXd drawn =
        DrawnBack(history, List(model.nuisances, "play_spring", "pull_back", joints.size, 0.0));
    joints.coupling -= drawn;
    joints.scale -= drawn.diagonal();
    joints.coupling.diagonal().setZero();
  }
}

void SayWhatStays(const Fits& found, const JointModel& joints, std::vector<std::string>& lines) {
  const auto say = [&](const char* effect, const char* why) {
    if (Has(found, effect)) lines.push_back(fmt::format("{}: {}", effect, why));
  };
  say("link_geometry", "the joints are right, and the links differ from the arm's file");
  say("tool_offset", "of the marker, not of a joint");
  say("tracker_registration", "of the tracker, not of the arm");
  say("torque_drift", "of a sensor, not of a joint");
  if (joints.droop.isZero(0.0) && joints.compliance.isZero(0.0)) {
    say("joint_friction", "no servo was found to give way to it");
    say("payload", "no servo was found to give way to it");
  }
}

}  // namespace

CommandModel CommandModelOf(const Arm& arm, const ArmModel& model,
                            const Eigen::Vector3d& gravity_m_s2) {
  const int n = arm.Size();
  CommandModel result{JointModel(n), {}};
  JointModel& joints = result.joints;
  const Fits& found = model.effects;
  Fits given = found;
  for (const EffectFit& fit : model.within_tolerance) given.push_back(WhatIsMeasured(fit, arm));
  const auto positive = [](const Eigen::VectorXd& list) { return list.cwiseMax(0.0); };
  for (int i = 0; i < n; ++i)
    joints.turns[std::size_t(i)] = arm.joints[std::size_t(i)].type == JointType::kRevolute;
  joints.delay_s = std::max(0.0, List(given, "command_latency", "delay_s", 1, 0.0)[0]);
  joints.lag_s = positive(List(given, "servo_lag", "time_s", n, 0.0));
  joints.droop = positive(List(given, "servo_droop", "compliance", n, 0.0));
  joints.compliance = positive(List(given, "joint_compliance", "compliance", n, 0.0));
  joints.inertia_s2 = List(model.nuisances, "servo_inertia", "inertia_over_stiffness_s2", n, 0.0);
  joints.offset = List(given, "joint_offset", "offset", n, 0.0);
  joints.scale = List(given, "joint_scale", "scale", n, 1.0);
  joints.coupling = Square(List(given, "joint_coupling", "matrix", n * n - n, 0.0), n);
  const Eigen::VectorXd width = List(found, "joint_backlash", "width", n, 0.0);
  const JointMatrix drag = Square(List(found, "joint_backlash", "drag", n * n - n, 0.0), n);
  joints.play = drag * width.asDiagonal();
  joints.play.diagonal() = width;
  TakeSprings(model, joints);
  if (!arm.links.empty() || Has(model.nuisances, "masses")) {
    const auto chain = EffortJoints(arm, model, given, result.not_corrected);
    joints.effort.emplace(chain, arm.T_RB.R.transpose() * gravity_m_s2);
    joints.effort_at_rest = !Has(model.nuisances, "masses");
  }
  SayWhatStays(model.effects, joints, result.not_corrected);
  return result;
}

}  // namespace flextip::arms
