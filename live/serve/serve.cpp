#include "live/serve/serve.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "live/serve/mailbox.h"
#include "live/serve/messages.h"
#include "live/serve/outlets.h"
#include "live/serve/photographer.h"
#include "live/serve/shift_times.h"
#include "simulation/virtual_robot/virtual_robot.h"

namespace flextip::live {
namespace {

using simulation::kSimulationStart_ns;
using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLook{20};  // how often the end is looked for

simulation::VirtualRobotSetup RobotOf(const simulation::Scenario& scenario, bool pictures,
                                      bool keep) {
  const simulation::LoopSetup& loop = scenario.loop;
  simulation::VirtualRobotSetup setup;
  setup.base = loop.base;
  setup.plant = loop.plant;
  setup.plant_options = loop.plant_options;
  setup.p_RW_start = loop.p_RW_start;
  setup.servo = loop.servo;
  setup.sensors = loop.sensors;
  setup.sensor_effects = loop.sensor_effects;
  setup.seed = loop.seed;
  setup.keep = keep;
  if (pictures) {
    setup.sensors.tip.reset();
    setup.picture_rate_hz = loop.base.cam0->calibration.rate_hz;
  }
  return setup;
}

TimeNs RealTime() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// One session.
class Session {
 public:
  Session(const simulation::Scenario& scenario, const simulation::Laparoscope* laparoscope,
          const ServeOptions& options)
      : options_(options),
        robot_(RobotOf(scenario, laparoscope != nullptr, options.keep)),
        rate_hz_(options.rate_hz > 0.0 ? options.rate_hz : scenario.loop.update_rate_hz),
        direction_noise_rad_(
            scenario.loop.sensors.tip ? scenario.loop.sensors.tip->direction_noise_rad : 0.0),
        p_RE_start_(robot_.Shape().T_RE().p),
        p_RE_(p_RE_start_),
        p_RW_start_(scenario.loop.p_RW_start),
        outlets_(
            options,
            [this](Outlets::Source source, WireMessage&& message) {
              mailbox_.Put(Mailbox::Mail{source, std::move(message)});
            },
            [this](WireEvent&& event) { mailbox_.Put(std::move(event)); }) {
    if (laparoscope != nullptr) {
      photographer_.emplace(*laparoscope, !options.lockstep,
                            [this](TimeNs t_ns, Image&& image) { Show(t_ns, std::move(image)); });
    }
  }

  ~Session() { mailbox_.Close(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  ServeResult Run() {
    if (options_.serving) options_.serving(outlets_.port());
    if (options_.lockstep) {
      RunLockstep();
    } else {
      RunRealTime();
    }
    photographer_.reset();
    return Finish();
  }

 private:
  bool Stopped() const { return options_.stop && options_.stop(); }
  bool DurationOver() const { return options_.duration_s && Elapsed() >= *options_.duration_s; }
  double Elapsed() const { return 1e-9 * static_cast<double>(robot_.Now() - kSimulationStart_ns); }

  void RunRealTime() {
    const SteadyClock::time_point begin = SteadyClock::now();
    offset_ns_ = RealTime() - kSimulationStart_ns;
    const auto simulated_now = [&] {
      return kSimulationStart_ns +
             std::chrono::duration_cast<std::chrono::nanoseconds>(SteadyClock::now() - begin)
                 .count();
    };
    const auto real = [&](TimeNs t_ns) {
      return begin + std::chrono::nanoseconds(t_ns - kSimulationStart_ns);
    };
    while (!Stopped() && !DurationOver()) {
      const auto samples = robot_.Advance(End(simulated_now()));
      Send(samples);
      if (!samples.empty()) NoteDelay(simulated_now() - samples.front().t_ns);
      const auto wait = std::min(real(robot_.NextDue()), SteadyClock::now() + kLook);
      while (const auto item = mailbox_.TakeUntil(wait)) {
        Send(robot_.Advance(End(simulated_now())));
        Take(*item);
        Send(robot_.Advance(robot_.Now()));
        if (SteadyClock::now() > wait) break;
      }
    }
  }

  void NoteDelay(TimeNs delay_ns) {
    figures_.longest_delay_s =
        std::max(figures_.longest_delay_s, 1e-9 * static_cast<double>(delay_ns));
  }

  /// The time, but no later than the end.
  TimeNs End(TimeNs t_ns) const {
    if (!options_.duration_s) return t_ns;
    return std::min<TimeNs>(t_ns, kSimulationStart_ns + std::llround(1e9 * *options_.duration_s));
  }

  void RunLockstep() {
    // Not TakeOne: samples that are sent before a client is there come when they like.
    while (!Stopped() && outlets_.Clients() == 0)
      if (const auto item = mailbox_.TakeUntil(SteadyClock::now() + kLook)) Take(*item);
    while (!Stopped() && !Left() && !DurationOver()) {
      outlets_.ForgetKept();
      Send(robot_.Advance(kSimulationStart_ns + std::llround(figures_.cycles * 1e9 / rate_hz_)));
      while (!outlets_.Settled() && !Stopped() && !Left()) {
      }
      Publish({kLockstepDevice, robot_.Now(), WireText{fmt::format("cycle {}", figures_.cycles)}});
      answered_ = false;
      while (!answered_ && !Stopped() && !Left()) TakeOne();
      if (answered_) ++figures_.cycles;
    }
  }

  /// Whether the client that commanded has gone, or all that were there.
  bool Left() {
    commanded_ = commanded_ || outlets_.HasCommander();
    return outlets_.Clients() == 0 || (commanded_ && !outlets_.HasCommander());
  }

  void TakeOne() {
    if (const auto item = mailbox_.TakeUntil(SteadyClock::now() + kLook)) {
      Take(*item);
      Send(robot_.Advance(robot_.Now()));
    }
  }

  void Take(const Mailbox::Item& item) {
    if (const auto* const event = std::get_if<WireEvent>(&item)) {
      Say(event->what);
      return;
    }
    const auto& [source, message] = std::get<Mailbox::Mail>(item);
    if (!outlets_.IsHeard(source)) {
      SayOnce(fmt::format("{}: a peer of another protocol commands, this one is not heard",
                          message.device));
      return;
    }
    const auto* const text = std::get_if<WireText>(&message.body);
    const auto* const transform = std::get_if<WireTransform>(&message.body);
    const bool moves = message.device == kServoDevice || message.device == kInterpolateDevice;
    if (moves && transform != nullptr) {
      TakeSetPoint(message, *transform);
    } else if (message.device == kCommandDevice && text != nullptr) {
      TakeCommand(text->text);
    } else {
      SayOnce(fmt::format("{}: no such device takes this message", message.device));
    }
  }

  void TakeSetPoint(const WireMessage& message, const WireTransform& set_point) {
    answered_ = true;
    if (message.t_ns == 0) {
      ++figures_.set_points_off;
      SayOnce(fmt::format("{}: found the time 0, which means invalid data: not followed",
                          message.device));
      return;
    }
    ++(robot_.MoveTo(set_point.T_RD.p) ? figures_.set_points : figures_.set_points_off);
  }

  void TakeCommand(const std::string& text) {
    ++figures_.commands;
    const auto command = CrtkCommandOf(text);
    if (command && robot_.Command(*command)) return;
    ++figures_.commands_refused;
    Say(fmt::format("{}: '{}' refused in {}", kCommandDevice, text, Text(robot_.State())));
  }

  void Send(const std::vector<simulation::VirtualSample>& samples) {
    for (const simulation::VirtualSample& sample : samples) {
      if (const auto* const due = std::get_if<simulation::PictureDue>(&sample.value)) {
        photographer_->Take(sample.t_ns, *due);
      } else if (auto message = MessageOf(sample, direction_noise_rad_, offset_ns_)) {
        Publish(*message);
      }
    }
    if (samples.empty()) return;
    const Eigen::Vector3d p_RE = robot_.Shape().T_RE().p;
    figures_.tip_travel_m += (p_RE - p_RE_).norm();
    p_RE_ = p_RE;
  }

  void Publish(const WireMessage& message) {
    if (outlets_.Send(message)) ++figures_.messages_sent;
  }

  /// From the photographer's thread, where there is one.
  void Show(TimeNs t_ns, Image&& image) {
    if (options_.save) {
      options_.save(t_ns + offset_ns_, image);
      const std::lock_guard lock(pictures_mutex_);
      pictures_.push_back({t_ns + offset_ns_, fmt::format("{}.png", t_ns + offset_ns_)});
    }
    const WireMessage message{"cam0", t_ns + offset_ns_, WireImage{std::move(image)}};
    if (outlets_.Send(message)) ++figures_.pictures_sent;
  }

  void Say(const std::string& line) const {
    if (options_.say) options_.say(line);
  }
  void SayOnce(const std::string& line) {
    if (said_.size() < kMostSaid && std::find(said_.begin(), said_.end(), line) == said_.end()) {
      said_.push_back(line);
      Say(line);
    }
  }

  ServeResult Finish() {
    const simulation::PlantShape& shape = robot_.Shape();
    figures_.duration_s = Elapsed();
    figures_.tip_from_start_m = (shape.T_RE().p - p_RE_start_).norm();
    figures_.wrist_from_start_m = (shape.p_RW_measured - p_RW_start_).norm();
    figures_.state = Text(robot_.State());
    figures_.fault = robot_.FaultReason();
    figures_.counts = outlets_.Counts();
    ServeResult result{figures_, robot_.Kept(), robot_.Truth()};
    ShiftTimes(offset_ns_, result.recording, result.truth);
    if (result.recording.command0) result.recording.command0->rate_hz = rate_hz_;
    if (!pictures_.empty()) result.recording.cam0->filenames = std::move(pictures_);
    return result;
  }

  static constexpr std::size_t kMostSaid = 100;

  const ServeOptions& options_;
  simulation::VirtualRobot robot_;
  double rate_hz_, direction_noise_rad_;
  Eigen::Vector3d p_RE_start_, p_RE_, p_RW_start_;
  TimeNs offset_ns_ = 0;  // of the wire's time from the simulated one
  ServeFigures figures_;
  bool answered_ = false, commanded_ = false;
  std::vector<std::string> said_;
  std::mutex pictures_mutex_;
  Series<std::string> pictures_;
  Mailbox mailbox_;
  Outlets outlets_;
  std::optional<Photographer> photographer_;
};

}  // namespace

ServeResult Serve(const simulation::Scenario& scenario, const simulation::Laparoscope* laparoscope,
                  const ServeOptions& options) {
  return Session(scenario, laparoscope, options).Run();
}

}  // namespace flextip::live
