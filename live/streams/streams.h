// The newest sample of each stream of a session, for a cycle that never waits.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/robot/crtk.h"
#include "live/streams/newest.h"
#include "live/streams/samples.h"

namespace flextip::live {

/// What arrived of a stream, and why samples went no further.
struct StreamCounts {
  long arrived = 0, accepted = 0;
  long invalid = 0;                                  ///< time 0: the peer says so
  long old = 0;                                      ///< repeated or out of order
  long unusable = 0;                                 ///< not finite, of another size or kind
  TimeNs first_arrived_ns = 0, last_arrived_ns = 0;  ///< of those accepted

  double Rate_hz() const;  ///< of those accepted; 0 for fewer than two
};

/// The streams that a cycle is given, as they are at an instant. Fixed size.
struct StreamInputs {
  std::optional<Arrived<WristSample>> wrist;
  std::optional<Arrived<SeenTip>> tip;
  std::optional<Arrived<EmSample>> em0, em1;
  std::optional<Arrived<Eigen::Vector4d>> strain;
  std::optional<Arrived<Eigen::Vector3d>> load;
  std::optional<Arrived<CrtkOperatingState>> state;
  std::optional<Arrived<GoalSample>> goal;
  /// Bit by bit: the stream's peer is gone; bit kRobotPeer: the robot's, kGoalPeer: that of the
  /// goals.
  std::uint32_t lost = 0;
};

/// Each stream has one thread that delivers it; Look belongs to the cycle's thread.
class Streams {
 public:
  /// A sample that was accepted, given from the thread that delivered it.
  using Observer = std::function<void(StreamName, const Arrived<AnySample>&)>;

  /// `session` must outlive the streams.
  explicit Streams(const Session& session, Observer observer = {});

  /// Takes a message of a stream that arrived at `arrived_ns`: calibrates it, takes the latency off
  /// its time, drops and counts what is invalid, old or unusable (of another kind, unit or day).
  /// Returns why a message is unusable, with the values found; otherwise nothing.
  std::string Take(StreamName stream, const WireMessage& message, TimeNs arrived_ns);
  /// Takes a sample of the tip by the session's own camera.
  void TakeTip(TimeNs t_ns, const SeenTip& tip, TimeNs arrived_ns);
  /// Takes the robot's operating state; a text that is none is counted.
  void TakeState(std::string_view text, TimeNs t_ns, TimeNs arrived_ns);
  /// Takes a goal: a pose or position in R of which the place counts. Returns why it is unusable.
  std::string TakeGoal(const WireMessage& message, TimeNs arrived_ns);
  /// Notes whether the peer of a stream (kRobotPeer, kGoalPeer) is there. At first it is not.
  void SetThere(int stream, bool there);

  StreamInputs Look();
  StreamCounts Counts(StreamName stream) const;
  long BadStates() const { return bad_states_; }

 private:
  struct Counters {
    std::atomic<long> arrived{0}, accepted{0}, invalid{0}, old{0}, unusable{0};
    std::atomic<TimeNs> first_arrived_ns{0}, last_arrived_ns{0};
    TimeNs last_t_ns = 0;  // of the delivering thread
  };
  std::string OtherClock(TimeNs t_ns, TimeNs arrived_ns) const;
  void Accept(StreamName stream, const Arrived<AnySample>& sample);

  const Session& session_;
  Observer observer_;
  Newest<Arrived<WristSample>> wrist_;
  Newest<Arrived<SeenTip>> tip_;
  Newest<Arrived<EmSample>> em0_, em1_;
  Newest<Arrived<Eigen::Vector4d>> strain_;
  Newest<Arrived<Eigen::Vector3d>> load_;
  Newest<Arrived<CrtkOperatingState>> state_;
  Newest<Arrived<GoalSample>> goal_;
  std::array<Counters, kStreams> counters_;
  std::atomic<std::uint32_t> lost_;
  std::atomic<long> bad_states_{0};
  TimeNs goal_t_ns_ = 0;  // of the delivering thread
};

/// Returns the time since 1970.
TimeNs Now_ns();

}  // namespace flextip::live
