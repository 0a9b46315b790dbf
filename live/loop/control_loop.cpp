#include "live/loop/control_loop.h"

#include <fmt/format.h>
#include <utility>

#include "live/camera/tip_camera.h"
#include "live/loop/beat.h"
#include "live/loop/real_time.h"
#include "live/loop/set_point.h"
#include "live/protocols/reports.h"
#include "live/publish/publisher.h"
#include "live/session/address.h"
#include "live/streams/streams.h"

namespace flextip::live {
namespace {

constexpr double kPauseWait_s = 1.0;  // for the robot's word that it is paused
constexpr std::size_t kMostCauses = 16;

class Loop {
 public:
  Loop(const Session& session, const LoopOptions& options, Recorder* recorder)
      : session_(session),
        options_(options),
        recorder_(recorder),
        page_(options.page),
        streams_(session,
                 [this](StreamName stream, const Arrived<AnySample>& sample) {
                   if (recorder_ != nullptr) recorder_->Take(stream, sample);
                   if (camera_) camera_->Note(stream, sample);
                 }),
        cycle_(session, options.wait || options.only_timing),
        T_BR_(session.robot.T_RB.Inverse()),
        T_WD_(session.robot.T_DW.Inverse()) {
    report_.causes.reserve(kMostCauses);
    set_point_.device = session.robot.command.device;
    if (session.robot.command_state) state_command_.device = session.robot.command_state->device;
  }

  LoopReport Run(const OpenPeers& open) {
    PeerHandlers handlers;
    handlers.message = [this](const Address& peer, WireMessage&& message) {
      Dispatch(peer, std::move(message));
    };
    handlers.event = [this](const Address& peer, WireEvent&& event) { Note(peer, event); };
    if (session_.publish) publisher_.emplace(session_);
    if (session_.camera) OpenCamera();
    peers_ = open(session_, handlers);
    begin_ns_ = Now_ns();
    if (session_.robot.lockstep) {
      RunInLockstep();
    } else {
      RunByClock();
    }
    peers_.reset();
    if (camera_) report_.camera = camera_->Counts();
    camera_.reset();
    if (page_ != nullptr) page_->End(report_.done);
    Finish();
    return std::move(report_);
  }

 private:
  void OpenCamera() {
    camera_.emplace(
        session_,
        [this](TimeNs t_ns, const SeenTip& tip, TimeNs arrived_ns) {
          streams_.TakeTip(t_ns, tip, arrived_ns);
        },
        [this](const std::string& what) {
          if (recorder_ != nullptr) recorder_->TakeEvent(Now_ns(), what);
          if (page_ != nullptr) page_->TakeEvent(Now_ns(), what);
        },
        [this](TimeNs t_ns, const Image& picture, const TipTrack& track) {
          if (page_ != nullptr) page_->TakePicture(t_ns, picture, track);
          if (publisher_) publisher_->TakePicture(t_ns, picture);
        });
  }

  // From the peers' threads.

  void Dispatch(const Address& peer, WireMessage&& message) {
    const TimeNs now_ns = Now_ns();
    const auto is_of = [&](const Address& address) {
      return address.SamePeer(peer) && address.device == message.device;
    };
    for (int i = 0; i < kStreams; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto& stream = session_.streams[at];
      if (!stream || !is_of(stream->address)) continue;
      const std::string why = streams_.Take(static_cast<StreamName>(i), message, now_ns);
      if (!why.empty()) Refuse(peer, stream->address, why, reports_[at]);
    }
    const RobotSetup& robot = session_.robot;
    const auto* text = std::get_if<WireText>(&message.body);
    if (robot.state && is_of(*robot.state) && text != nullptr)
      streams_.TakeState(text->text, message.t_ns, now_ns);
    if (session_.goal && is_of(*session_.goal)) {
      const std::string why = streams_.TakeGoal(message, now_ns);
      if (!why.empty()) Refuse(peer, *session_.goal, why, goal_reports_);
    }
    if (robot.lockstep && is_of(*robot.lockstep)) beats_.Give(message.t_ns, now_ns);
    auto* picture = std::get_if<WireImage>(&message.body);
    const bool of_camera = session_.camera && session_.camera->address &&
                           is_of(*session_.camera->address) && message.t_ns > 0;
    if (of_camera && picture != nullptr)
      camera_->Take(message.t_ns, std::move(picture->image), now_ns);
  }

  void Refuse(const Address& peer, const Address& from, const std::string& why, Reports& reports) {
    const auto note = [&](WireEvent&& event) { Note(peer, event); };
    reports.Tell(note, fmt::format("{}: {}", Text(from), why), from.device);
  }

  void Note(const Address& peer, const WireEvent& event) {
    if (recorder_ != nullptr) recorder_->TakeEvent(Now_ns(), event.what);
    if (page_ != nullptr) page_->TakeEvent(Now_ns(), event.what);
    if (event.kind == WireEvent::Kind::kRefused) return;
    const bool there = event.kind == WireEvent::Kind::kConnected;
    const auto concerns = [&](const Address& address) {
      return address.SamePeer(peer) && (event.device.empty() || event.device == address.device);
    };
    for (int i = 0; i < kStreams; ++i) {
      const auto& stream = session_.streams[static_cast<std::size_t>(i)];
      if (stream && concerns(stream->address)) streams_.SetThere(i, there);
    }
    if (concerns(session_.robot.command)) streams_.SetThere(kRobotPeer, there);
    if (session_.goal && concerns(*session_.goal)) streams_.SetThere(kGoalPeer, there);
  }

  // From the cycle's thread.

  void RunByClock() {
    const RealTime real_time;  // may take a second: all memory is brought in
    begin_ns_ = Now_ns();
    report_.had_priority = real_time.HasPriority();
    report_.had_locked_memory = real_time.HasLockedMemory();
    ClockBeats beats(session_.rate_hz);
    while (!IsOver(Now_ns())) {
      Step(beats.Next());
      report_.missed = beats.Missed();
    }
  }

  void RunInLockstep() {
    while (!IsOver(Now_ns())) {
      if (const auto beat = beats_.Next()) Step(*beat);
    }
  }

  void Step(const Beat& beat) {
    CycleRecord& record = record_;
    record.due_ns = beat.due_ns;
    record.woke_ns = beat.woke_ns;
    record.inputs.t_ns = beat.t_ns;
    record.inputs.streams = streams_.Look();
    record.inputs.stop = stops_;
    record.outputs = cycle_.Step(record.inputs);
    record.sent_ns = Send(record) ? Now_ns() : 0;
    if (recorder_ != nullptr) recorder_->Take(record);
    Count(record);
    if (page_ != nullptr) Show(record);
    if (publisher_) publisher_->Take(cycle_.LastCommand());
    if (options_.progress) options_.progress(record);
  }

  bool Send(const CycleRecord& record) {
    const CycleOutputs& outputs = record.outputs;
    const auto& state = record.inputs.streams.state;
    const bool known_still = state && state->value.state != CrtkState::kEnabled;
    // In lockstep the robot waits for a set-point, and one that it cannot use moves nothing.
    const bool has_one = outputs.has_command || session_.robot.lockstep.has_value();
    // First, for in lockstep the robot goes on at the set-point.
    if (const auto command = StateCommand(record)) {
      state_command_.t_ns = outputs.t_ns;
      state_command_.body = WireText{Name(*command)};
      (void)peers_->Send(*session_.robot.command_state, state_command_);
    }
    bool sent = false;
    if (has_one && (!options_.only_timing || known_still)) {
      WireTransform transform;
      transform.T_RD = T_BR_ * SetPointOf(record) * T_WD_;
      set_point_.t_ns = outputs.has_command ? outputs.t_ns : 0;
      set_point_.body = transform;
      sent = peers_->Send(session_.robot.command, set_point_);
      report_.unsent += !sent;
    }
    return sent;
  }

  Pose SetPointOf(const CycleRecord& record) const {
    const CycleOutputs& outputs = record.outputs;
    const auto& wrist = record.inputs.streams.wrist;
    if (!wrist || !wrist->value.q_RW) return {outputs.R_RW, outputs.p_RW_command};
    return SetPoint({outputs.R_RW, wrist->value.p_RW}, outputs.p_RW_command, session_.base.p_RP);
  }

  /// The person's command at the page comes before the cycle's own.
  std::optional<CrtkCommand> StateCommand(const CycleRecord& record) {
    const std::optional<CrtkCommand>& own = record.outputs.state_command;
    if (page_ == nullptr || options_.only_timing || !session_.robot.command_state) return own;
    return page_->operators().Next(record.inputs.t_ns, record.inputs.streams.state, own);
  }

  void Show(const CycleRecord& record) {
    snapshot_.record = record;
    snapshot_.command = cycle_.LastCommand();
    const TipPath* const path = cycle_.Path();
    snapshot_.on_path = path != nullptr;
    if (path != nullptr) {
      snapshot_.p_RE_start = path->Start();
      snapshot_.deviation_m = path->Deviation(record.outputs.p_RE);
    }
    snapshot_.cycles = report_.cycles;
    snapshot_.missed = report_.missed;
    for (int i = 0; i < kStreams; ++i)
      snapshot_.accepted[static_cast<std::size_t>(i)] =
          streams_.Counts(static_cast<StreamName>(i)).accepted;
    page_->Take(snapshot_);
  }

  void Count(const CycleRecord& record) {
    const CycleOutputs& outputs = record.outputs;
    ++report_.cycles;
    ++holds_[static_cast<std::size_t>(outputs.hold)];
    report_.step_limited += outputs.step_limited;
    report_.speed_limited += outputs.speed_limited;
    report_.acceleration_limited += outputs.acceleration_limited;
    report_.workspace_limited += outputs.workspace_limited;
    report_.fixture_limited += outputs.fixture_limited;
    report_.done |= outputs.done;
    last_hold_ = outputs.hold;
    if (IsNews(outputs.cause, last_cause_) && report_.causes.size() < kMostCauses)
      report_.causes.push_back({outputs.t_ns, outputs.cause});
    last_cause_ = outputs.cause;
    const auto& state = record.inputs.streams.state;
    enabled_ = state && state->value.state == CrtkState::kEnabled;
    report_.wake.Add(record.woke_ns - record.due_ns);
    if (record.sent_ns == 0) return;
    report_.work.Add(record.sent_ns - record.woke_ns);
    if (record.inputs.streams.wrist && !session_.robot.lockstep)
      report_.sample_to_command.Add(record.sent_ns - record.inputs.streams.wrist->t_ns);
  }

  /// Whether the run is over. Before it is, the robot is paused and has said so.
  bool IsOver(TimeNs now_ns) {
    const auto since_s = [&](TimeNs t_ns) { return 1e-9 * static_cast<double>(now_ns - t_ns); };
    if (!stops_) {
      const bool too_long = options_.duration_s && since_s(begin_ns_) >= *options_.duration_s;
      const bool wanted = (options_.stop && options_.stop()) ||
                          (page_ != nullptr && page_->operators().StopWanted());
      stops_ = too_long || wanted || report_.done;
      if (!stops_) return false;
      stop_ns_ = now_ns;
    }
    if (options_.only_timing || !session_.robot.command_state || !enabled_) return true;
    return since_s(stop_ns_) >= kPauseWait_s;
  }

  void Finish() {
    report_.seconds = 1e-9 * static_cast<double>(Now_ns() - begin_ns_);
    report_.ends_paused = !enabled_;
    report_.last_hold = Name(last_hold_);
    for (std::size_t i = 0; i < holds_.size(); ++i)
      if (holds_[i] > 0) report_.holds[Name(static_cast<Hold>(i))] = holds_[i];
    for (int i = 0; i < kStreams; ++i)
      report_.streams[static_cast<std::size_t>(i)] = streams_.Counts(static_cast<StreamName>(i));
    report_.bad_states = streams_.BadStates();
  }

  const Session& session_;
  const LoopOptions& options_;
  Recorder* recorder_;
  Page* page_;
  Streams streams_;
  Reports goal_reports_;
  std::array<Reports, kStreams> reports_;  // each of the thread that delivers the stream
  GivenBeats beats_;
  Cycle cycle_;
  std::optional<Publisher> publisher_;
  std::optional<TipCamera> camera_;
  std::unique_ptr<Peers> peers_;
  const Pose T_BR_, T_WD_;
  WireMessage set_point_, state_command_;
  CycleRecord record_;
  PageSnapshot snapshot_;
  LoopReport report_;
  std::array<long, 16> holds_{};
  Hold last_hold_ = Hold::kNone;
  FoundCause last_cause_;
  TimeNs begin_ns_ = 0, stop_ns_ = 0;
  bool stops_ = false, enabled_ = false;
};

}  // namespace

LoopReport RunLoop(const Session& session, const LoopOptions& options, Recorder* recorder,
                   const OpenPeers& open) {
  return Loop(session, options, recorder).Run(open);
}

}  // namespace flextip::live
