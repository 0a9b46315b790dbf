#include "live/streams/calibrate.h"

namespace flextip::live {
namespace {

/// Puts the sample into `recording`, which has none, runs `change`, and takes it out again.
template <class T, class Value>
void Through(Recording& recording, Series<T>& series, Value& value, TimeNs& t_ns,
             const Session& session) {
  series.assign(1, {t_ns, value});
  for (const UsedCalibration& used : session.calibrations)
    ApplyCalibration(used.file, used.calibration, recording);
  if (series.size() != 1) return;
  t_ns = series.front().t_ns;
  value = series.front().value;
}

}  // namespace

Arrived<AnySample> Calibrate(const Session& session, StreamName stream,
                             const Arrived<AnySample>& sample) {
  Arrived<AnySample> result = sample;
  if (session.calibrations.empty()) return result;
  Recording recording = session.uncalibrated;
  const auto through = [&](auto& series, auto& value) {
    Through(recording, series, value, result.t_ns, session);
  };
  switch (stream) {
    case StreamName::kWrist:
      through(recording.wrist0->samples, std::get<WristSample>(result.value));
      break;
    case StreamName::kTip:
      through(recording.vision0->tips, std::get<SeenTip>(result.value).tip);
      break;
    case StreamName::kEm0:
      through(recording.em0->samples, std::get<EmSample>(result.value));
      break;
    case StreamName::kEm1:
      through(recording.em1->samples, std::get<EmSample>(result.value));
      break;
    case StreamName::kStrain:
      through(recording.strain0->moments_Nm, std::get<Eigen::Vector4d>(result.value));
      break;
    case StreamName::kLoad:
      through(recording.load0->f_tip_N, std::get<Eigen::Vector3d>(result.value));
      break;
  }
  return result;
}

}  // namespace flextip::live
