#include "simulation/virtual_robot/virtual_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace flextip::simulation {
namespace {

TimeNs SpanNs(double seconds) { return std::llround(1e9 * seconds); }

/// The sample of `series` at `t_ns`, if it is its last; what is not kept is forgotten.
template <class T, class Use>
void TakeLast(Series<T>& series, TimeNs t_ns, bool keep, const Use& use) {
  if (!series.empty() && series.back().t_ns == t_ns) use(series.back().value);
  if (!keep) series.clear();
}

}  // namespace

VirtualRobot::VirtualRobot(const VirtualRobotSetup& setup)
    : setup_(setup),
      plant_(setup.plant, setup.plant_options),
      sensors_(setup.sensors, setup.seed, setup.sensor_effects),
      machine_(SpanNs(setup.homing_s)),
      servo_(setup.servo, setup.p_RW_start, setup.seed),
      p_RW_solved_(setup.p_RW_start),
      curves_(setup.sensor_effects.camera_latency_s),
      kept_(setup.base) {
  shape_ = plant_.Solve(servo_.p_RW());
  if (!shape_.IsUsable())
    throw InputError(fmt::format("the shaft has no equilibrium at the start: {}", shape_.message));
}

TimeNs VirtualRobot::PictureTime() const {
  return kSimulationStart_ns + SpanNs(pictures_ / setup_.picture_rate_hz);
}

TimeNs VirtualRobot::StateTime() const { return kSimulationStart_ns + SpanNs(state_ticks_); }

TimeNs VirtualRobot::NextDue() const {
  TimeNs next = StateTime();
  if (const auto due = sensors_.NextDue()) next = std::min(next, *due);
  if (const auto due = machine_.NextDue()) next = std::min(next, *due);
  if (setup_.picture_rate_hz > 0.0) next = std::min(next, PictureTime());
  return next;
}

std::vector<VirtualSample> VirtualRobot::Advance(TimeNs t_ns) {
  std::vector<VirtualSample> samples = std::exchange(waiting_, {});
  for (TimeNs due_ns = NextDue(); due_ns <= t_ns; due_ns = NextDue()) {
    MoveWrist(due_ns);
    Solve(due_ns);
    Sense(due_ns, samples);
  }
  MoveWrist(t_ns);
  return samples;
}

void VirtualRobot::MoveWrist(TimeNs t_ns) {
  if (t_ns <= now_ns_) return;
  servo_.Advance(t_ns);
  now_ns_ = t_ns;
}

void VirtualRobot::Solve(TimeNs t_ns) {
  const double t_s = 1e-9 * static_cast<double>(t_ns - kSimulationStart_ns);
  PlantShape shape = plant_.Solve(servo_.p_RW(), t_s);
  if (shape.IsUsable()) {
    shape_ = std::move(shape);
    p_RW_solved_ = servo_.p_RW();
    return;
  }
  if (machine_.State().state != CrtkState::kFault) {
    fault_reason_ =
        fmt::format("the shaft lost its equilibrium at {:.3f} s: {}", t_s, shape.message);
    machine_.Fail();
    SayState(t_ns);
  }
  servo_.PutAt(p_RW_solved_);
}

void VirtualRobot::Sense(TimeNs t_ns, std::vector<VirtualSample>& samples) {
  sensors_.Sample(shape_, t_ns, kept_);
  TakeNew(t_ns, samples);
  if (setup_.picture_rate_hz > 0.0) curves_.Add(t_ns, shape_.Curve());
  if (setup_.picture_rate_hz > 0.0 && PictureTime() <= t_ns) {
    samples.push_back({t_ns, PictureDue{curves_.Before(t_ns), pictures_}});
    ++pictures_;
  }
  if (machine_.Advance(t_ns)) SayState(t_ns);
  if (StateTime() <= t_ns) {
    if (waiting_.empty()) SayState(t_ns);
    ++state_ticks_;
  }
  for (VirtualSample& state : waiting_) samples.push_back(std::move(state));
  waiting_.clear();
  if (setup_.keep)
    truth_.push_back({t_ns, {shape_.T_RE().p, shape_.T_RE().Quaternion(), servo_.p_RW()}});
}

void VirtualRobot::TakeNew(TimeNs t_ns, std::vector<VirtualSample>& samples) {
  const auto add = [&](auto value) { samples.push_back({t_ns, std::move(value)}); };
  const bool keep = setup_.keep;
  if (kept_.wrist0) TakeLast(kept_.wrist0->samples, t_ns, keep, add);
  if (kept_.em0)
    TakeLast(kept_.em0->samples, t_ns, keep, [&](const EmSample& s) { add(EmReading{0, s}); });
  if (kept_.em1)
    TakeLast(kept_.em1->samples, t_ns, keep, [&](const EmSample& s) { add(EmReading{1, s}); });
  if (kept_.strain0) {
    TakeLast(kept_.strain0->moments_Nm, t_ns, keep,
             [&](const Eigen::Vector4d& m) { add(StrainReading{m}); });
  }
  if (kept_.load0) {
    TakeLast(kept_.load0->f_tip_N, t_ns, keep,
             [&](const Eigen::Vector3d& f) { add(ForceReading{f}); });
  }
  if (kept_.vision0) TakeLast(kept_.vision0->tips, t_ns, keep, add);
}

void VirtualRobot::SayState(TimeNs t_ns) { waiting_.push_back({t_ns, machine_.State()}); }

bool VirtualRobot::Command(CrtkCommand command) {
  const std::string before = Text(machine_.State());
  if (!machine_.Take(command, now_ns_)) return false;
  servo_.Stay();
  if (Text(machine_.State()) != before) SayState(now_ns_);
  return true;
}

bool VirtualRobot::MoveTo(const Eigen::Vector3d& p_RW) {
  if (!machine_.Follows() || !p_RW.allFinite()) return false;
  servo_.MoveTo(p_RW);
  if (!setup_.keep) return true;
  if (!kept_.command0) {
    kept_.command0.emplace();
    kept_.command0->comment = "set-points of a client";
  }
  Series<Eigen::Vector3d>& commands = kept_.command0->p_RW;
  if (!commands.empty() && commands.back().t_ns == now_ns_) {
    commands.back().value = p_RW;
  } else {
    commands.push_back({now_ns_, p_RW});
  }
  return true;
}

}  // namespace flextip::simulation
