// Streams whose clocks a calibration found: new times for their samples.
#include <fmt/format.h>

#include <cmath>

#include "recording/calibrations/calibration_use.h"

namespace flextip {
namespace {

constexpr double kMostRate = 0.01;

void Retime(const std::function<TimeNs(TimeNs)>& time, auto& series) {
  for (auto& sample : series) sample.t_ns = time(sample.t_ns);
}

}  // namespace

/// A rate needs its origin, and both an offset.
void CalibrationUse::CheckClock(const std::string& name) const {
  const std::string stream = name.substr(0, name.find('.'));
  for (const char* other : {".time_offset_s", ".time_rate", ".time_origin_s"}) {
    if (!Finds(stream + other))
      Refuse(name, fmt::format("there is no {}{} with it", stream, other));
  }
}

void CalibrationUse::SetClock(const std::string& name) {
  const std::string stream = name.substr(0, name.find('.'));
  const TimeNs by_ns = std::llround(1e9 * Numbers(name, 1)[0]);
  double rate = 0.0, origin_ns = 0.0;
  if (Finds(stream + ".time_rate") || Finds(stream + ".time_origin_s")) {
    CheckClock(name);
    rate = Numbers(stream + ".time_rate", 1)[0];
    origin_ns = 1e9 * Numbers(stream + ".time_origin_s", 1)[0];
    if (!(std::abs(rate) <= kMostRate)) {
      Refuse(stream + ".time_rate", fmt::format("found {}, expected within {}", rate, kMostRate));
    }
  }
  const auto time = [=](TimeNs t_ns) {
    return t_ns + by_ns + std::llround(rate * (static_cast<double>(t_ns) - origin_ns));
  };
  if (stream == "cam0" || stream == "cam1") {
    ShiftFrames(name, time);
  } else if (stream == "wrist0") {
    Retime(time, Need(recording_.wrist0, name).samples);
    if (recording_.command0) Retime(time, recording_.command0->p_RW);  // of the same robot
  } else if (stream == "em0") {
    Retime(time, Need(recording_.em0, name).samples);
    if (recording_.em1) Retime(time, recording_.em1->samples);  // of the same tracker
  } else if (stream == "strain0") {
    Retime(time, Need(recording_.strain0, name).moments_Nm);
  } else if (stream == "load0") {
    Retime(time, Need(recording_.load0, name).f_tip_N);
  } else {
    Refuse(name, "unknown name");
  }
}

void CalibrationUse::ShiftFrames(const std::string& name,
                                 const std::function<TimeNs(TimeNs)>& time) {
  CameraStream& camera = Camera(name);
  const auto shift = [&](CameraStream& eye) {
    Retime(time, eye.filenames);
    Retime(time, eye.frame_numbers);
  };
  if (camera.filenames.empty() && camera.frame_numbers.empty() && !SeenBy(name)) {
    Refuse(name, "there are no frames with times of their own to be shifted");
  }
  shift(camera);
  if (name == "cam0.time_offset_s" && recording_.cam1 && !Finds("cam1.time_offset_s")) {
    shift(*recording_.cam1);  // both eyes have one clock
  }
  if (SeenBy(name)) Retime(time, recording_.vision0->tips);
}

}  // namespace flextip
