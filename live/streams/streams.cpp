#include "live/streams/streams.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include "live/session/plausible.h"
#include "live/streams/calibrate.h"

namespace flextip::live {
namespace {

/// A sample whose time is further from that of its arrival is of another day or clock. Were it
/// taken, a time to come would shut out all that are right.
constexpr double kOtherClock_s = 20.0;

template <class T>
void LookAt(Newest<Arrived<T>>& newest, std::optional<Arrived<T>>& sample) {
  if (const Arrived<T>* value = newest.Look()) sample = *value;
}

/// Makes the wrist in R of the device's pose in the robot's frame. Says why it cannot.
std::string PlaceInR(const RobotSetup& robot, WristSample& wrist) {
  if (!wrist.q_RW) {
    if (!robot.T_DW.p.isZero(0.0)) return "found no orientation, expected one for robot.T_DW";
    wrist.p_RW = robot.T_RB * wrist.p_RW;
    return {};
  }
  const Pose T_RW = robot.T_RB * Pose{wrist.q_RW->toRotationMatrix(), wrist.p_RW} * robot.T_DW;
  wrist = {T_RW.p, T_RW.Quaternion()};
  return {};
}

std::uint32_t AllOf(const Session& session) {
  std::uint32_t bits = 1U << kRobotPeer;
  if (session.goal) bits |= 1U << kGoalPeer;
  for (int i = 0; i < kStreams; ++i)
    if (session.streams[static_cast<std::size_t>(i)]) bits |= 1U << i;
  return bits;
}

}  // namespace

double StreamCounts::Rate_hz() const {
  const TimeNs span = last_arrived_ns - first_arrived_ns;
  return accepted > 1 && span > 0
             ? static_cast<double>(accepted - 1) * 1e9 / static_cast<double>(span)
             : 0.0;
}

Streams::Streams(const Session& session, Observer observer)
    : session_(session), observer_(std::move(observer)), lost_(AllOf(session)) {}

std::string Streams::Take(StreamName stream, const WireMessage& message, TimeNs arrived_ns) {
  const auto i = static_cast<std::size_t>(stream);
  Counters& counters = counters_[i];
  ++counters.arrived;
  if (message.t_ns <= 0) {
    ++counters.invalid;
    return {};
  }
  std::string why;
  auto sample = SampleIn(stream, message, why);
  if (!sample) {
    ++counters.unusable;
    return why;
  }
  why = OtherClock(message.t_ns, arrived_ns);
  if (why.empty() && stream == StreamName::kWrist)
    why = PlaceInR(session_.robot, std::get<WristSample>(*sample));
  if (!why.empty()) {
    ++counters.unusable;
    return why;
  }
  const double latency_s = session_.streams[i] ? session_.streams[i]->latency.value_s : 0.0;
  const TimeNs t_ns = message.t_ns - std::llround(1e9 * latency_s);
  Accept(stream, Calibrate(session_, stream, {t_ns, arrived_ns, *sample}));
  return {};
}

/// Says where a time is not of this machine's clock. In lockstep the robot's is not that of
/// arrivals.
std::string Streams::OtherClock(TimeNs t_ns, TimeNs arrived_ns) const {
  const double off_s = 1e-9 * static_cast<double>(t_ns - arrived_ns);
  if (session_.robot.lockstep || std::abs(off_s) <= kOtherClock_s) return {};
  return fmt::format("found a time {:.6g} s {} this machine's, expected its clock within {:g} s",
                     std::abs(off_s), off_s > 0.0 ? "after" : "before", kOtherClock_s);
}

void Streams::TakeTip(TimeNs t_ns, const SeenTip& tip, TimeNs arrived_ns) {
  ++counters_[static_cast<std::size_t>(StreamName::kTip)].arrived;
  Accept(StreamName::kTip, {t_ns, arrived_ns, tip});
}

void Streams::Accept(StreamName stream, const Arrived<AnySample>& sample) {
  Counters& counters = counters_[static_cast<std::size_t>(stream)];
  if (sample.t_ns <= counters.last_t_ns) {
    ++counters.old;
    return;
  }
  counters.last_t_ns = sample.t_ns;
  if (counters.accepted.load() == 0) counters.first_arrived_ns = sample.arrived_ns;
  counters.last_arrived_ns = sample.arrived_ns;
  ++counters.accepted;
  const auto put = [&](auto& newest) {
    using Value = std::decay_t<decltype(newest.Look()->value)>;
    newest.Put({sample.t_ns, sample.arrived_ns, std::get<Value>(sample.value)});
  };
  switch (stream) {
    case StreamName::kWrist:
      put(wrist_);
      break;
    case StreamName::kTip:
      put(tip_);
      break;
    case StreamName::kEm0:
      put(em0_);
      break;
    case StreamName::kEm1:
      put(em1_);
      break;
    case StreamName::kStrain:
      put(strain_);
      break;
    case StreamName::kLoad:
      put(load_);
      break;
  }
  if (observer_) observer_(stream, sample);
}

void Streams::TakeState(std::string_view text, TimeNs t_ns, TimeNs arrived_ns) {
  if (const auto state = CrtkOperatingStateOf(text)) {
    state_.Put({t_ns, arrived_ns, *state});
  } else {
    ++bad_states_;
  }
}

std::string Streams::TakeGoal(const WireMessage& message, TimeNs arrived_ns) {
  if (message.t_ns <= 0) return "found the stamp 0, which means invalid data";
  const auto* transform = std::get_if<WireTransform>(&message.body);
  if (transform == nullptr) return "found no pose or position, expected one";
  const Eigen::Vector3d& p_RE = transform->T_RD.p;
  if (!(p_RE.norm() <= kPlace.most)) {
    return fmt::format(
        "found a goal {:.6g} m from R, expected at most {:g} m: is it in another unit?",
        p_RE.norm(), kPlace.most);
  }
  if (message.t_ns <= goal_t_ns_)
    return fmt::format("found the time {} after {}, expected a later one", message.t_ns,
                       goal_t_ns_);
  if (std::string why = OtherClock(message.t_ns, arrived_ns); !why.empty()) return why;
  goal_t_ns_ = message.t_ns;
  goal_.Put({message.t_ns, arrived_ns, {p_RE}});
  return {};
}

void Streams::SetThere(int stream, bool there) {
  const std::uint32_t bit = 1U << stream;
  if (there) {
    lost_.fetch_and(~bit);
  } else {
    lost_.fetch_or(bit);
  }
}

StreamInputs Streams::Look() {
  StreamInputs inputs;
  LookAt(wrist_, inputs.wrist);
  LookAt(tip_, inputs.tip);
  LookAt(em0_, inputs.em0);
  LookAt(em1_, inputs.em1);
  LookAt(strain_, inputs.strain);
  LookAt(load_, inputs.load);
  LookAt(state_, inputs.state);
  LookAt(goal_, inputs.goal);
  inputs.lost = lost_.load();
  return inputs;
}

StreamCounts Streams::Counts(StreamName stream) const {
  const Counters& c = counters_[static_cast<std::size_t>(stream)];
  return {c.arrived,  c.accepted,         c.invalid,        c.old,
          c.unusable, c.first_arrived_ns, c.last_arrived_ns};
}

TimeNs Now_ns() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return TimeNs(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace flextip::live
