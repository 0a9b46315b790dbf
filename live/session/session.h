// A session file: which streams a control run has, which robot, and what it is to do
// (docs/usage/control.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "control/supervision/rate_limits.h"
#include "core/pose.h"
#include "diagnosis/model/extended_model.h"
#include "live/protocols/protocol.h"
#include "recording/calibrations/apply.h"
#include "recording/calibrations/clock.h"
#include "recording/recording.h"
#include "task/task_reader.h"

namespace flextip::live {

/// The streams that a cycle takes its measurements from.
enum class StreamName : std::uint8_t { kWrist, kTip, kEm0, kEm1, kStrain, kLoad };
inline constexpr int kStreams = 6;
/// Beside the streams: the robot, and who says where the tip is to go.
inline constexpr int kRobotPeer = kStreams, kGoalPeer = kStreams + 1;
/// Returns the name as in session files and recordings: "wrist0", "vision0", "em0", ...
const char* Name(StreamName stream);

struct StreamSetup {
  Address address;
  Latency latency;
  double stale_s = 0.1;  ///< without a new sample for longer, and its latency, the stream is stale
};

/// A camera whose pictures the tracker looks at: a device, file or URL, or a peer.
struct CameraSetup {
  std::string video;
  std::optional<Address> address;
  Latency latency;
  bool latency_known = false;  ///< it is stated in the session, or a calibration found its clock
  std::vector<FoundClock> clocks;  ///< of the calibrations, one after the other

  /// Returns when a picture that came with the stamp `t_ns` was taken.
  TimeNs TimeOf(TimeNs t_ns) const;
  double stale_s = 0.2;
};

struct RobotSetup {
  Address command;
  std::optional<Address> state, command_state;
  Pose T_RB;                        ///< R from the frame in which wrist0 and commands stand
  Pose T_DW;                        ///< the shaft's held end W in the frame D whose pose they are
  std::optional<Address> lockstep;  ///< a cycle for each of its messages, in place of a clock
};

/// Where viewers see the run, by OpenIGTLink.
struct PublishSetup {
  int port = 0;              ///< 0: a free one
  bool any_address = false;  ///< of other machines, too
  double rate_hz = 30.0;
};

struct LimitSetup {
  double max_step_m = 0.0;                ///< of a command from the measured wrist
  double max_speed_m_s = 0.0;             ///< of the commanded wrist
  double max_acceleration_m_s2 = 0.0;     ///< of the commanded wrist
  double max_jerk_m_s3 = 0.0;             ///< of the commanded wrist; 0: no limit
  std::optional<WorkspaceBox> workspace;  ///< of the tip's goal
  double resume_after_s = 0.1;            ///< a hold ends so long after its cause
};

struct PathPlace {
  std::optional<Eigen::Vector3d> p_start;  ///< of a path in R: where the first leg starts (m, in R)
  double average_s = 0.5;                  ///< the tip at the start is the mean over so long
};

struct Session {
  std::filesystem::path file;
  std::vector<std::filesystem::path> named_files;  ///< as written in it: calibrations, models, ...
  /// Instrument, port, gravity, camera, collar, and the streams with their noises, without samples;
  /// calibrated.
  Recording base;
  Recording uncalibrated;  ///< the same before the calibrations
  std::vector<UsedCalibration> calibrations;
  double port_prior_m = 0.0;
  std::array<std::optional<StreamSetup>, kStreams> streams;
  std::optional<CameraSetup> camera;
  RobotSetup robot;
  double rate_hz = 0.0;    ///< of the cycle
  int window_samples = 0;  ///< of the window estimator; 0: each sample by itself
  std::optional<diagnosis::ExtendedModel> model;
  LimitSetup limits;
  std::optional<PublishSetup> publish;
  std::optional<PathPlace> path;  ///< of task.path; absent: the cycle only watches
  std::optional<Address> goal;    ///< in place of task.path's waypoints: goals of a peer
  TipTask task;
  std::vector<std::string> warnings;

  const std::optional<StreamSetup>& Of(StreamName stream) const {
    return streams[static_cast<std::size_t>(stream)];
  }
  bool HasTip() const { return Of(StreamName::kTip).has_value() || camera.has_value(); }
  /// Returns the latency of a stream as the session states it, with the camera's for the tip. By a
  /// clock that was found, a camera of this machine is later by so much.
  Latency LatencyOf(StreamName stream) const;
  /// Returns the deviation of the times of a stream's samples near `t_ns`, by its latency and, for
  /// wrist, tip and EM sensor, its clock (s).
  double TimeSdOf(StreamName stream, TimeNs t_ns) const;
  /// Returns whether the controller follows a tip whose age on arrival nobody knows: pictures of a
  /// camera that stamps them as they arrive, without a stated latency.
  bool DelayIsUnknown() const;
  /// Where nothing sees the tip, an EM sensor near it is its measurement.
  bool EmIsTip() const { return !HasTip() && Of(StreamName::kEm0).has_value(); }
};

/// Throws InputError with file and line for keys that are missing, unknown or of the wrong kind,
/// and values that are impossible or implausible (a shaft of 600 m). Files are named relative to
/// the session's folder; those that are not there, relative to `other_folder`.
Session ReadSession(const std::filesystem::path& file,
                    const std::filesystem::path& other_folder = {});

}  // namespace flextip::live
