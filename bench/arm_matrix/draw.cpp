#include "bench/arm_matrix/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "testdata/held_arm/faults.h"

namespace flextip::bench {
namespace {

using Rng = std::mt19937_64;
using simulation::ArmSensors;

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

struct Kind {
  const char* effect;
  std::vector<int> sensors;  ///< of kSensors, that can show it
};

int OneOf(Rng& rng, int count) { return int(rng() % std::uint64_t(count)); }

const std::vector<Kind>& Kinds() {
  static const std::vector<Kind> kinds{
      {"joint_offset", {0, 5}},      {"joint_scale", {0, 5}},          {"joint_coupling", {0, 5}},
      {"joint_backlash", {0, 1}},  // without gravity: efforts would lie
      {"joint_compliance", {5}},     {"command_latency", {3, 4, 5}},   {"servo_lag", {3, 4, 5}},
      {"joint_friction", {2, 4, 5}}, {"link_geometry", {1, 5}},        {"payload", {2, 4, 5}},
      {"tool_offset", {1, 5}},       {"tracker_registration", {1, 5}},
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
    hidden::PutFault(first.effect, SizeOf(which), rng, hidden.faults);
  }
  while (one.part == "pair" && hidden.effects.size() < 2) {
    const Kind& second = kinds[std::size_t(OneOf(rng, int(kinds.size())))];
    const int shared = SharedSensors(first, second, rng);
    if (shared < 0 || hidden.effects.contains(second.effect)) continue;
    sensors = shared;
    hidden.effects.insert(second.effect);
    hidden::PutFault(second.effect, SizeOf(which), rng, hidden.faults);
  }
  hidden.sensors = kSensors[std::size_t(sensors)].name;
  hidden.streams = kSensors[std::size_t(sensors)].streams;
  return hidden;
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
