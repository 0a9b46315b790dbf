// Streams whose clocks a calibration found: new times for their samples.
#include <fmt/format.h>

#include <cmath>

#include "recording/calibrations/calibration_use.h"
#include "recording/calibrations/clock.h"

namespace flextip {
namespace {

constexpr double kMostRate = 0.01;

void Retime(const FoundClock& clock, auto& series) {
  for (auto& sample : series) sample.t_ns = clock.TimeOf(sample.t_ns);
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
  (void)Numbers(name, 1);
  if (Finds(stream + ".time_rate") || Finds(stream + ".time_origin_s")) {
    CheckClock(name);
    const double rate = Numbers(stream + ".time_rate", 1)[0];
    (void)Numbers(stream + ".time_origin_s", 1);
    if (!(std::abs(rate) <= kMostRate)) {
      Refuse(stream + ".time_rate", fmt::format("found {}, expected within {}", rate, kMostRate));
    }
  }
  const FoundClock clock = *ClockIn(found_, stream);
  if (stream == "cam0" || stream == "cam1") {
    ShiftFrames(name, clock);
  } else if (stream == "wrist0") {
    Retime(clock, Need(recording_.wrist0, name).samples);
    recording_.wrist0->clock.Add(clock.noise);
    if (recording_.command0) Retime(clock, recording_.command0->p_RW);  // of the same robot
  } else if (stream == "em0") {
    Retime(clock, Need(recording_.em0, name).samples);
    recording_.em0->clock.Add(clock.noise);
    if (recording_.em1) Retime(clock, recording_.em1->samples);  // of the same tracker
  } else if (stream == "strain0") {
    Retime(clock, Need(recording_.strain0, name).moments_Nm);
  } else if (stream == "load0") {
    Retime(clock, Need(recording_.load0, name).f_tip_N);
  } else {
    Refuse(name, "unknown name");
  }
}

void CalibrationUse::ShiftFrames(const std::string& name, const FoundClock& clock) {
  const bool has_camera =
      name.starts_with("cam0.") ? recording_.cam0.has_value() : recording_.cam1.has_value();
  if (!has_camera && SeenBy(name)) {  // the tips alone
    RetimeTips(clock);
    return;
  }
  CameraStream& camera = Camera(name);
  const auto shift = [&](CameraStream& eye) {
    Retime(clock, eye.filenames);
    Retime(clock, eye.frame_numbers);
  };
  if (camera.filenames.empty() && camera.frame_numbers.empty() && !SeenBy(name)) {
    Refuse(name, "there are no frames with times of their own to be shifted");
  }
  shift(camera);
  if (name == "cam0.time_offset_s" && recording_.cam1 && !Finds("cam1.time_offset_s")) {
    shift(*recording_.cam1);  // both eyes have one clock
  }
  if (SeenBy(name)) RetimeTips(clock);
}

void CalibrationUse::RetimeTips(const FoundClock& clock) {
  Retime(clock, recording_.vision0->tips);
  recording_.vision0->clock.Add(clock.noise);
}

}  // namespace flextip
