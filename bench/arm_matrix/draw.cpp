#include "bench/arm_matrix/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "core/error.h"

namespace flextip::bench {
namespace {

using Rng = std::mt19937_64;
using simulation::ArmFaults;
using simulation::ArmSensors;

constexpr int kJoints = 3;  // the third slides

struct Sensors {
  const char* name;
  ArmSensors streams;
};
const std::array<Sensors, 6> kSensors{{
    {"seen", {.command = false, .encoders = true, .seen = true}},
    {"pose", {.command = false, .encoders = true, .pose = true}},
    {"torque", {.command = false, .encoders = true, .torque = true}},
    {"command", {.command = true, .encoders = true}},
    {"command+torque", {.command = true, .encoders = true, .torque = true}},
    {"all", {.command = true, .encoders = true, .seen = true, .pose = true, .torque = true}},
}};

/// Puts an effect of so many tolerances in.
using Put = std::function<void(double tolerances, Rng&, ArmFaults&)>;

struct Kind {
  const char* effect;
  std::vector<int> sensors;  ///< of kSensors, that can show it
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
       {0, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         const int joint = OneOf(rng, kJoints);
         f.encoder_offset = Nothing();
         f.encoder_offset[joint] = Sign(rng) * size * (joint == 2 ? 0.0002 : 0.0005);
       }},
      {"joint_scale",
       {0, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         f.encoder_scale = Nothing();
         f.encoder_scale[OneOf(rng, kJoints)] = Sign(rng) * size * 0.0005;
       }},
      {"joint_coupling",
       {0, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         f.routing = Eigen::Matrix3d::Identity();
         const bool down = rng() % 2 == 0;
         f.routing(down ? 1 : 0, down ? 0 : 1) = Sign(rng) * size * 0.001;
       }},
      {"joint_backlash",
       {0, 1},  // without gravity: efforts would lie
       [](double size, Rng& rng, ArmFaults& f) {
         f.play = Nothing();
         f.play[OneOf(rng, 2)] = size * 0.0005;
       }},
      {"joint_compliance",
       {5},
       [](double size, Rng& rng, ArmFaults& f) {
         f.cable_stiffness = Eigen::Vector3d(4e4, 4e4, 4e6);
         f.cable_stiffness[OneOf(rng, 2)] = 1.0 / (size * 0.0002);
       }},
      {"command_latency",
       {3, 4, 5},
       [](double size, Rng&, ArmFaults& f) { f.command_delay_s = size * 0.003; }},
      {"servo_lag",
       {3, 4, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         f.servo_stiffness = Eigen::Vector3d(5e3, 5e3, 5e5);
         f.servo_damping = 1e-3 * f.servo_stiffness;
         const int joint = OneOf(rng, 2);
         f.servo_damping[joint] = std::min(0.1, size * 0.003) * f.servo_stiffness[joint];
       }},
      {"joint_friction",
       {2, 4, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         const int joint = OneOf(rng, 2);
         f.motor_coulomb = f.motor_viscous = Nothing();
         (rng() % 2 == 0 ? f.motor_coulomb : f.motor_viscous)[joint] = size * 0.02;
       }},
      {"link_geometry",
       {1, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         f.a_change_m = Nothing();
         f.a_change_m[1] = Sign(rng) * size * 0.0002;  // the last one's is the marker's place
       }},
      {"payload",
       {2, 4, 5},
       [](double size, Rng& rng, ArmFaults& f) {
         const bool elbow = rng() % 2 == 0;
         f.payload.push_back(
             {elbow ? 1 : 2, size * 0.01,
              elbow ? Eigen::Vector3d(0.2, 0.0, 0.0) : Eigen::Vector3d(0.05, 0.0, 0.1)});
       }},
      {"tool_offset",
       {1, 5},
       [](double size, Rng& rng, ArmFaults& f) { f.marker_m = size * 0.0002 * Direction(rng); }},
      {"tracker_registration",
       {1, 5},
       [](double size, Rng& rng, ArmFaults& f) { f.tracker_m = size * 0.0005 * Direction(rng); }},
  };
  return kinds;
}

double SizeOf(int which) { return 6.0 * std::pow(3.0, which); }

int SharedSensors(const Kind& a, const Kind& b, Rng& rng) {
  std::vector<int> shared;
  for (const int s : a.sensors)
    if (std::find(b.sensors.begin(), b.sensors.end(), s) != b.sensors.end()) shared.push_back(s);
  return shared.empty() ? -1 : shared[std::size_t(OneOf(rng, int(shared.size())))];
}

}  // namespace

HiddenArm Draw(const ArmCase& one) {
  std::uint64_t salt = 0;
  for (const char c : one.part) salt = 31 * salt + std::uint64_t(c);
  std::seed_seq seed{one.first_seed, salt, std::uint64_t(one.number)};
  Rng rng(seed);
  HiddenArm hidden;
  hidden.motion.seed = rng();
  const auto& kinds = Kinds();
  const int which = one.number % 3;
  const auto& first = kinds[std::size_t(one.number / 3) % kinds.size()];
  int sensors = first.sensors[std::size_t(OneOf(rng, int(first.sensors.size())))];
  if (one.part == "healthy" || one.part == "form") {
    sensors = one.part == "form" ? 0 : one.number % int(kSensors.size());
    if (one.part == "form") hidden.eccentric_rad = SizeOf(which) * 0.0005;
  } else {
    hidden.size = std::array{"subtle", "plain", "strong"}[std::size_t(which)];
    hidden.effects.insert(first.effect);
    first.put(SizeOf(which), rng, hidden.faults);
  }
  while (one.part == "pair" && hidden.effects.size() < 2) {
    const Kind& second = kinds[std::size_t(OneOf(rng, int(kinds.size())))];
    const int shared = SharedSensors(first, second, rng);
    if (shared < 0 || hidden.effects.contains(second.effect)) continue;
    sensors = shared;
    hidden.effects.insert(second.effect);
    second.put(SizeOf(which), rng, hidden.faults);
  }
  hidden.sensors = kSensors[std::size_t(sensors)].name;
  hidden.streams = kSensors[std::size_t(sensors)].streams;
  return hidden;
}

void PutFault(const std::string& effect, double tolerances, std::mt19937_64& rng,
              ArmFaults& faults) {
  for (const Kind& kind : Kinds()) {
    if (kind.effect != effect) continue;
    kind.put(tolerances, rng, faults);
    return;
  }
  throw InputError(effect + ": no fault of an arm is that effect");
}

Recording RecordingOf(const HiddenArm& hidden) {
  Recording recording =
      RecordArm(simulation::SmallArm(), hidden.faults, hidden.streams, hidden.motion);
  if (hidden.eccentric_rad > 0.0)
    for (auto& sample : recording.joints0->q)
      sample.value[0] += hidden.eccentric_rad * std::sin(7.0 * sample.value[0]);
  return recording;
}

}  // namespace flextip::bench
