// A virtual robot behind OpenIGTLink, and ROS 2 and UDP where they are wanted: in real time, or as
// fast as its client answers.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/image.h"
#include "live/wire.h"
#include "recording/recording.h"
#include "recording/truth.h"
#include "simulation/closed_loop/scenario.h"
#include "simulation/render/laparoscope.h"

namespace flextip::live {

struct ServeOptions {
  int port = 0;                    ///< 0: a free one
  bool any_address = false;        ///< with ROS 2: the network interface that DDS chooses
  std::optional<int> ros2_domain;  ///< empty: no ROS 2
  std::optional<int> udp_port;     ///< poses go to this port of this machine too
  bool lockstep = false;
  double rate_hz = 0.0;              ///< of lockstep's cycles; 0: the scenario's
  std::optional<double> duration_s;  ///< simulated; empty: until `stop`
  bool keep = false;                 ///< keep samples and truth for a recording
  std::function<bool()> stop;        ///< asked every 20 ms at least
  /// Told the port once it is open.
  std::function<void(int port)> serving;
  /// Told in one line what befell a client, or why a message was of no use.
  std::function<void(const std::string&)> say;
  /// Given every picture; from a thread of its own in real time.
  std::function<void(TimeNs, const Image&)> save;
};

struct ServeFigures {
  double duration_s = 0.0;  ///< simulated
  int cycles = 0;           ///< of lockstep
  std::int64_t messages_sent = 0;
  std::int64_t pictures_sent = 0;
  std::int64_t set_points = 0;      ///< that were followed
  std::int64_t set_points_off = 0;  ///< that came while the robot was not ready, or without time
  std::int64_t commands = 0, commands_refused = 0;
  double tip_travel_m = 0.0;      ///< of the true tip, from sample to sample
  double tip_from_start_m = 0.0;  ///< at the end, of the true tip
  double wrist_from_start_m = 0.0;
  double longest_delay_s = 0.0;  ///< real time: of a sample behind its time
  std::string state;             ///< of the robot at the end
  std::string fault;             ///< why it was in FAULT; empty: it never was
  WireCounts counts;
};

/// With `keep`: what the robot's sensors gave, the set-points followed as command0, and the truth;
/// stamped as on the wire.
struct ServeResult {
  ServeFigures figures;
  Recording recording;
  Series<TruthSample> truth;
};

/// Serves the scenario's instrument until `stop`, the duration's end, or in lockstep until the
/// client that commanded has left. Lockstep begins when the first client is there; then the same
/// commands give the same samples, bit for bit. `laparoscope` null: no pictures, the tip by its
/// figures where the scenario has `sensors.tip`. Throws InputError where the shaft has no
/// equilibrium at the start and WorkError where the port is taken or without
/// OpenIGTLink; and where ROS 2 is wanted and cannot be had.
ServeResult Serve(const simulation::Scenario& scenario, const simulation::Laparoscope* laparoscope,
                  const ServeOptions& options);

}  // namespace flextip::live
