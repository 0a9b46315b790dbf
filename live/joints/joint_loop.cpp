#include "live/joints/joint_loop.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "live/loop/beat.h"
#include "live/loop/real_time.h"
#include "live/streams/newest.h"
#include "live/streams/streams.h"

namespace flextip::live {
namespace {

constexpr double kPausedWait_s = 1.0;  // for the robot's word that it is paused
constexpr std::size_t kMostJointEvents = 200;

struct Measured {
  TimeNs arrived_ns = 0;
  JointVector q, effort;
};

class JointLoop {
 public:
  JointLoop(const JointSession& session, JointCycle cycle, int joints,
            const JointLoopOptions& options)
      : session_(session), cycle_(std::move(cycle)), joints_(joints), options_(options) {
    set_point_.device = session.command.device;
    set_point_.body = WireNumbers{std::vector<double>(std::size_t(joints), 0.0)};
    if (session.command_state) state_command_.device = session.command_state->device;
  }

  JointLoopReport Run(const OpenJointPeers& open) {
    PeerHandlers handlers;
    handlers.message = [this](const Address& peer, WireMessage&& m) { Take(peer, m); };
    handlers.event = [this](const Address& peer, WireEvent&& e) { Note(peer, e); };
    std::vector<Address> out{session_.command};
    if (session_.command_state) out.push_back(*session_.command_state);
    peers_ = open({session_.measured, session_.state}, out, handlers);
    {
      const RealTime real_time;
      ClockBeats beats(session_.rate_hz);
      begin_ns_ = Now_ns();
      while (!IsOver()) {
        Step(beats.Next().t_ns);
        report_.missed = beats.Missed();
      }
    }
    peers_.reset();
    return std::move(report_);
  }

 private:
  // From the peers' threads.

  void Take(const Address& peer, const WireMessage& message) {
    const auto is_of = [&](const Address& address) {
      return address.SamePeer(peer) && address.device == message.device;
    };
    const TimeNs now_ns = Now_ns();
    const auto* text = std::get_if<WireText>(&message.body);
    const auto* numbers = std::get_if<WireNumbers>(&message.body);
    if (is_of(session_.state) && text != nullptr) {
      if (const auto state = CrtkOperatingStateOf(text->text)) {
        state_.Put(state);
      } else {
        ++bad_;
      }
    } else if (is_of(session_.measured) && numbers != nullptr) {
      const auto& values = numbers->values;
      const auto n = std::size_t(joints_);
      if (message.t_ns <= 0 || (values.size() != n && values.size() != 2 * n)) {
        ++bad_;
        return;
      }
      Measured measured;
      measured.arrived_ns = now_ns;
      measured.q = Eigen::Map<const Eigen::VectorXd>(values.data(), joints_);
      if (values.size() == 2 * n)
        measured.effort = Eigen::Map<const Eigen::VectorXd>(values.data() + n, joints_);
      measured_.Put(measured);
    }
  }

  void Note(const Address& peer, const WireEvent& event) {
    {
      const std::lock_guard lock(mutex_);
      if (events_.size() < kMostJointEvents) events_.push_back(event.what);
    }
    const auto concerns = [&](const Address& address) {
      return address.SamePeer(peer) && (event.device.empty() || event.device == address.device);
    };
    if (event.kind == WireEvent::Kind::kRefused) return;
    if (concerns(session_.measured)) lost_ = event.kind == WireEvent::Kind::kLost;
  }

  // From the cycle's thread.

  void Step(TimeNs t_ns) {
    JointRecord record;
    record.inputs.t_ns = t_ns;
    if (const Measured* measured = measured_.Look()) {
      record.inputs.measured_ns = measured->arrived_ns;
      record.inputs.q = measured->q;
      record.inputs.effort = measured->effort;
    }
    if (const auto* state = state_.Look()) record.inputs.state = *state;
    record.inputs.lost = lost_;
    record.inputs.stop = stops_;
    record.outputs = cycle_.Step(record.inputs);
    const JointOutputs& outputs = record.outputs;
    if (outputs.state_command && session_.command_state) {
      state_command_.t_ns = t_ns;
      state_command_.body = WireText{Name(*outputs.state_command)};
      (void)peers_->Send(*session_.command_state, state_command_);
    }
    if (outputs.has_command) {
      set_point_.t_ns = t_ns;
      auto& values = std::get<WireNumbers>(set_point_.body).values;
      std::copy(outputs.q.data(), outputs.q.data() + outputs.q.size(), values.begin());
      record.sent = peers_->Send(session_.command, set_point_);
      report_.unsent += !record.sent;
    }
    ++report_.cycle_count;
    report_.limited += outputs.rate_limited || outputs.correction_limited;
    report_.done = report_.done || outputs.hold == JointHold::kDone;
    if (!over_ || outputs.hold != JointHold::kBadTime) report_.last_hold = outputs.hold;
    if (outputs.over && !over_) {
      over_ = true;
      over_ns_ = t_ns;
    }
    enabled_ = record.inputs.state && record.inputs.state->state == CrtkState::kEnabled;
    if (report_.cycles.size() < options_.most_cycles) report_.cycles.push_back(record);
  }

  /// Whether the run is over. Before it is, the robot is paused and has said so.
  bool IsOver() {
    const TimeNs now_ns = Now_ns();
    const auto since_s = [&](TimeNs t_ns) { return 1e-9 * static_cast<double>(now_ns - t_ns); };
    const bool too_long = options_.duration_s && since_s(begin_ns_) >= *options_.duration_s;
    stops_ = stops_ || too_long || (options_.stop && options_.stop());
    bool ends = false;
    if (over_) ends = !session_.command_state || !enabled_ || since_s(over_ns_) >= kPausedWait_s;
    if (!ends) return false;
    report_.bad_messages = bad_;
    const std::lock_guard lock(mutex_);
    report_.events = events_;
    return true;
  }

  const JointSession& session_;
  JointCycle cycle_;
  int joints_;
  const JointLoopOptions& options_;
  Newest<Measured> measured_;
  Newest<std::optional<CrtkOperatingState>> state_;
  std::atomic<bool> lost_{false};
  std::atomic<long> bad_{0};
  std::mutex mutex_;
  std::vector<std::string> events_;
  std::unique_ptr<Peers> peers_;
  WireMessage set_point_, state_command_;
  JointLoopReport report_;
  TimeNs begin_ns_ = 0, over_ns_ = 0;
  bool stops_ = false, over_ = false, enabled_ = false;
};

}  // namespace

JointLoopReport RunJoints(const JointSession& session, JointCycle cycle, int joints,
                          const JointLoopOptions& options, const OpenJointPeers& open) {
  const OpenJointPeers usual = [](const auto& in, const auto& out, const PeerHandlers& handlers) {
    return OpenPeersAt(in, out, handlers);
  };
  return JointLoop(session, std::move(cycle), joints, options).Run(open ? open : usual);
}

}  // namespace flextip::live
