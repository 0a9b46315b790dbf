// The tip in the pictures of a session's camera, as a stream beside the others.
#pragma once

#include <array>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/image.h"
#include "live/session/session.h"
#include "live/streams/samples.h"
#include "pipeline/instrument_tracker.h"

namespace flextip::live {

/// What became of the pictures.
struct CameraCounts {
  long pictures = 0, seen = 0;
  long left_out = 0;  ///< a newer one came before the tracker was free
  long refused = 0;   ///< of another size than the camera's
};

/// Takes the newest picture and looks for the tip: on a thread of its own, so that the cycle never
/// waits for a picture; in lockstep at once, so that equal inputs give equal tips.
class TipCamera {
 public:
  using Tip = std::function<void(TimeNs t_ns, const SeenTip& tip, TimeNs arrived_ns)>;
  using Event = std::function<void(const std::string& what)>;
  using Seen = std::function<void(TimeNs t_ns, const Image& picture, const TipTrack& track)>;

  /// `tip` is given each tip that was seen, with the picture's time; `event` a line where a
  /// picture or the video cannot be used; `seen` each picture with what was found in it, from the
  /// thread that looked. `session` has a camera, and outlives this. Throws
  /// InputError for a camera or collar that cannot be used.
  TipCamera(const Session& session, Tip tip, Event event, Seen seen = {});
  ~TipCamera();
  TipCamera(const TipCamera&) = delete;
  TipCamera& operator=(const TipCamera&) = delete;

  /// Takes a picture with the time its peer gave. Waits for nothing, but in lockstep.
  void Take(TimeNs t_ns, Image image, TimeNs arrived_ns);
  /// Notes a sample, by which the shaft's model says where to look.
  void Note(StreamName stream, const Arrived<AnySample>& sample);

  CameraCounts Counts() const;

 private:
  struct Picture {
    TimeNs t_ns = 0, arrived_ns = 0;
    Image image;
  };
  bool Fits(const Image& image);
  void Run(const std::stop_token& stop);
  void RunVideo(const std::stop_token& stop);
  void Look(const Picture& picture);
  SensorReadings ReadingsAt(TimeNs t_ns);

  const Session& session_;
  Tip tip_;
  Event event_;
  Seen seen_;
  InstrumentTracker tracker_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Picture> newest_;
  std::array<std::deque<Arrived<AnySample>>, kStreams> samples_;  // of the last second
  CameraCounts counts_;
  std::jthread looks_, video_;
};

}  // namespace flextip::live
