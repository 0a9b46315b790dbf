#include "testdata/held_arm/faults.h"

#include <algorithm>
#include <functional>

#include "core/error.h"

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;
using simulation::ArmFaults;

constexpr int kJoints = 3;  // the third slides

/// Puts an effect of so many tolerances in.
using Put = std::function<void(double tolerances, Rng&, ArmFaults&)>;

struct Kind {
  const char* effect;
  Put put;
};

double Sign(Rng& rng) { return rng() % 2 == 0 ? 1.0 : -1.0; }
int OneOf(Rng& rng, int count) { return int(rng() % std::uint64_t(count)); }
Eigen::VectorXd Nothing() { return Eigen::VectorXd::Zero(kJoints); }
Eigen::Vector3d Direction(Rng& rng) {
  const int axis = OneOf(rng, 3);
  return Sign(rng) * Eigen::Vector3d::Unit(axis);
}

const std::vector<Kind>& Kinds() {
  static const std::vector<Kind> kinds{
      {"joint_offset",
       [](double size, Rng& rng, ArmFaults& f) {
         const int joint = OneOf(rng, kJoints);
         f.encoder_offset = Nothing();
         f.encoder_offset[joint] = Sign(rng) * size * (joint == 2 ? 0.0002 : 0.0005);
       }},
      {"joint_scale",
       [](double size, Rng& rng, ArmFaults& f) {
         f.encoder_scale = Nothing();
         f.encoder_scale[OneOf(rng, kJoints)] = Sign(rng) * size * 0.0005;
       }},
      {"joint_coupling",
       [](double size, Rng& rng, ArmFaults& f) {
         f.routing = Eigen::Matrix3d::Identity();
         const bool down = rng() % 2 == 0;
         f.routing(down ? 1 : 0, down ? 0 : 1) = Sign(rng) * size * 0.001;
       }},
      {"joint_backlash",
       [](double size, Rng& rng, ArmFaults& f) {
         f.play = Nothing();
         f.play[OneOf(rng, 2)] = size * 0.0005;
       }},
      {"joint_compliance",
       [](double size, Rng& rng, ArmFaults& f) {
         f.cable_stiffness = Eigen::Vector3d(4e4, 4e4, 4e6);
         f.cable_stiffness[OneOf(rng, 2)] = 1.0 / (size * 0.0002);
       }},
      {"command_latency",
       [](double size, Rng&, ArmFaults& f) { f.command_delay_s = size * 0.003; }},
      {"servo_lag",
       [](double size, Rng& rng, ArmFaults& f) {
         f.servo_stiffness = Eigen::Vector3d(5e3, 5e3, 5e5);
         f.servo_damping = 1e-3 * f.servo_stiffness;
         const int joint = OneOf(rng, 2);
         f.servo_damping[joint] = std::min(0.1, size * 0.003) * f.servo_stiffness[joint];
       }},
      {"joint_friction",
       [](double size, Rng& rng, ArmFaults& f) {
         const int joint = OneOf(rng, 2);
         f.motor_coulomb = f.motor_viscous = Nothing();
         (rng() % 2 == 0 ? f.motor_coulomb : f.motor_viscous)[joint] = size * 0.02;
       }},
      {"link_geometry",
       [](double size, Rng& rng, ArmFaults& f) {
         f.a_change_m = Nothing();
         f.a_change_m[1] = Sign(rng) * size * 0.0002;  // the last one's is the marker's place
       }},
      {"payload",
       [](double size, Rng& rng, ArmFaults& f) {
         const bool elbow = rng() % 2 == 0;
         f.payload.push_back(
             {elbow ? 1 : 2, size * 0.01,
              elbow ? Eigen::Vector3d(0.2, 0.0, 0.0) : Eigen::Vector3d(0.05, 0.0, 0.1)});
       }},
      {"tool_offset",
       [](double size, Rng& rng, ArmFaults& f) { f.marker_m = size * 0.0002 * Direction(rng); }},
      {"tracker_registration",
       [](double size, Rng& rng, ArmFaults& f) { f.tracker_m = size * 0.0005 * Direction(rng); }},
  };
  return kinds;
}

}  // namespace

void PutFault(const std::string& effect, double tolerances, Rng& rng, ArmFaults& faults) {
  for (const Kind& kind : Kinds()) {
    if (kind.effect != effect) continue;
    kind.put(tolerances, rng, faults);
    return;
  }
  throw InputError(effect + ": no fault of an arm is that effect");
}

}  // namespace flextip::hidden
