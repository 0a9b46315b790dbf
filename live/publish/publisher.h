// What viewers such as 3D Slicer see of a run: tip, shaft, wrist and camera, by an OpenIGTLink
// server.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/image.h"
#include "live/openigtlink/server.h"
#include "live/session/session.h"
#include "live/streams/newest.h"
#include "pipeline/instrument_controller.h"

namespace flextip::live {

/// Sends on a thread of its own, at the session's rate at most, whatever is new: in R, with the
/// cycle's time. Viewers command nothing: their messages are dropped.
///
/// | device | message |
/// |---|---|
/// | `tip` | TRANSFORM: the tip as estimated, x along it |
/// | `tip_covariance` | NDARRAY: 9 numbers of its place, row by row (mm^2) |
/// | `wrist` | TRANSFORM, as measured |
/// | `shaft` | POLYDATA: the shaft as a line |
/// | `cam0` | IMAGE: the picture the tip was last looked for in |
class Publisher {
 public:
  /// `session.publish` must be there. Throws WorkError where the port is taken, or without
  /// OpenIGTLink.
  explicit Publisher(const Session& session);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Takes a cycle's result; from the cycle's thread, which never waits.
  void Take(const ControllerCommand& command) { newest_.Put(command); }
  /// Takes a picture with its time; from one other thread.
  void TakePicture(TimeNs t_ns, const Image& picture);

  int port() const { return server_.port(); }

 private:
  void Run(const std::stop_token& stop);
  void Send(const ControllerCommand& command);
  void SendPicture();

  const PublishSetup setup_;
  Newest<ControllerCommand> newest_;
  TimeNs sent_ns_ = 0;
  std::mutex picture_mutex_;
  WireMessage picture_;  // empty where it was sent
  OpenIgtLinkServer server_;
  std::jthread thread_;
};

}  // namespace flextip::live
