#include <fmt/format.h>

#include "live/session/address.h"
#include "live/session/plausible.h"
#include "live/session/session_file.h"
#include "recording/cameras/camera_file.h"
#include "recording/streams/sensor_streams.h"

namespace flextip::live {
namespace {

Content ContentOf(StreamName stream) {
  switch (stream) {
    case StreamName::kTip:
      return Content::kTip;
    case StreamName::kStrain:
      return Content::kMoments;
    case StreamName::kLoad:
      return Content::kForce;
    case StreamName::kWrist:
    case StreamName::kEm0:
    case StreamName::kEm1:
      break;
  }
  return Content::kPose;
}

class SourceReader {
 public:
  explicit SourceReader(SessionFile& file) : file_(file) {}

  void Read() {
    const YamlMap sources = file_.Section(file_.top, "sources");
    Recording& base = file_.session.base;
    const auto wrist = ReadStream(sources, StreamName::kWrist, 0.1);
    if (!wrist) throw sources.Error("wrist0", "is missing: without it there is no command");
    base.wrist0 = WristStream{Comment(StreamName::kWrist),
                              RateOf(*wrist),
                              NumberIn(*wrist, "position_noise_m", kNoise),
                              NumberInOr(*wrist, "orientation_noise_rad", kAngleNoise, 0.0),
                              {}};
    base.em0 = ReadEm(sources, StreamName::kEm0);
    base.em1 = ReadEm(sources, StreamName::kEm1);
    if (const auto map = ReadStream(sources, StreamName::kStrain, 0.1)) ReadStrain(*map);
    if (const auto map = ReadStream(sources, StreamName::kLoad, 0.1)) {
      base.load0 = LoadStream{Comment(StreamName::kLoad),
                              RateOf(*map),
                              NumberIn(*map, "force_noise_N", kForceNoise),
                              {}};
    }
    if (const auto map = ReadStream(sources, StreamName::kTip, 0.2)) {
      VisionStream& vision = base.vision0.emplace();
      vision.comment = Comment(StreamName::kTip);
      vision.rate_hz = RateOf(*map);
      vision.registration_noise_m = NumberInOr(*map, "registration_noise_m", kNoise, 0.0);
      vision.registration_noise_rad = NumberInOr(*map, "registration_noise_rad", kAngleNoise, 0.0);
    }
    if (sources.Has("cam0")) ReadCamera(file_.Section(sources, "cam0"), sources);
  }

 private:
  /// Everything a stream has but its noises. Empty where `sources` has no such stream.
  std::optional<YamlMap> ReadStream(const YamlMap& sources, StreamName stream,
                                    double default_stale_s) {
    const std::string key = Name(stream);
    if (!sources.Has(key)) return {};
    const YamlMap map = file_.Section(sources, key);
    StreamSetup& setup = file_.session.streams[static_cast<std::size_t>(stream)].emplace();
    const auto address = ReadAddress(map, file_.sections, ContentOf(stream));
    if (!address)
      throw sources.Error(key, fmt::format("found no source, expected {}", ProtocolKeys()));
    setup.address = *address;
    setup.latency = ReadLatency(map);
    setup.stale_s = NumberInOr(map, "stale_s", kStale, default_stale_s);
    return map;
  }

  Latency ReadLatency(const YamlMap& map) {
    Latency latency;
    if (!map.Has("latency_s")) return latency;
    if (map.IsText("latency_s")) {
      latency.value_s = NumberIn(map, "latency_s", kTime);
      return latency;
    }
    const YamlMap section = file_.Section(map, "latency_s");
    latency.value_s = NumberIn(section, "value", kTime);
    latency.sd_s = NumberInOr(section, "sd", kTime, 0.0);
    return latency;
  }

  double RateOf(const YamlMap& map) const { return NumberInOr(map, "rate_hz", kRate, 100.0); }

  std::string Comment(StreamName stream) const {
    return fmt::format("live, {}", Text(file_.session.Of(stream)->address));
  }

  std::optional<EmStream> ReadEm(const YamlMap& sources, StreamName stream) {
    const auto map = ReadStream(sources, stream, 0.1);
    if (!map) return {};
    const bool on_port = stream == StreamName::kEm1;
    EmStream em;
    em.comment = Comment(stream);
    em.rate_hz = RateOf(*map);
    em.orientation_noise_rad = NumberIn(*map, "orientation_noise_rad", kAngleNoise);
    em.position_noise_m = on_port ? NumberInOr(*map, "position_noise_m", kNoise, 0.0)
                                  : NumberIn(*map, "position_noise_m", kNoise);
    if (!on_port) {
      em.distance_from_tip_m = map->NonNegative("distance_from_tip_m");
      const double length = file_.session.base.instrument.length_m;
      if (em.distance_from_tip_m > length) {
        throw map->Error("distance_from_tip_m",
                         fmt::format("found {}, expected at most the shaft's length {}",
                                     em.distance_from_tip_m, length));
      }
    }
    em.registration_noise_m = NumberInOr(*map, "registration_noise_m", kNoise, 0.0);
    em.registration_noise_rad = NumberInOr(*map, "registration_noise_rad", kAngleNoise, 0.0);
    return em;
  }

  void ReadStrain(const YamlMap& map) {
    StrainStream& strain = file_.session.base.strain0.emplace();
    strain.comment = Comment(StreamName::kStrain);
    strain.rate_hz = RateOf(map);
    strain.moment_noise_Nm = NumberIn(map, "moment_noise_Nm", kMomentNoise);
    const auto s = map.Numbers("stations_from_wrist_m", 2);
    const double length = file_.session.base.instrument.length_m;
    if (!(0 <= s[0] && s[0] < s[1] && s[1] <= length)) {
      throw map.Error("stations_from_wrist_m",
                      fmt::format("found [{}, {}], expected 0 <= s1 < s2 <= the shaft's length {}",
                                  s[0], s[1], length));
    }
    strain.station_from_wrist_m[0] = s[0];
    strain.station_from_wrist_m[1] = s[1];
  }

  void ReadCamera(const YamlMap& map, const YamlMap& sources) {
    if (file_.session.Of(StreamName::kTip)) {
      throw sources.Error("cam0", "found a camera and vision0, expected one of them");
    }
    CameraSetup& camera = file_.session.camera.emplace();
    camera.address = ReadAddress(map, file_.sections, Content::kPicture);
    camera.video = map.TextOr("video", "");
    if (camera.address.has_value() == !camera.video.empty()) {
      throw sources.Error("cam0", "expected one source: video or openigtlink");
    }
    camera.latency = ReadLatency(map);
    camera.latency_known = map.Has("latency_s");
    camera.stale_s = NumberInOr(map, "stale_s", kStale, camera.stale_s);
    ReadLog log;
    CameraStream& stream = file_.session.base.cam0.emplace();
    stream.comment = "live camera";
    stream.calibration = ReadCameraCalibration(file_.Beside(map.Text("sensor")), &log);
    file_.session.base.tags0 = ReadCollarFile(file_.Beside(map.Text("collar")), log);
    file_.session.warnings.insert(file_.session.warnings.end(), log.warnings.begin(),
                                  log.warnings.end());
    VisionStream& vision = file_.session.base.vision0.emplace();
    vision.comment = "tip by vision, as the cycle was given it";
    vision.rate_hz = stream.calibration.rate_hz;
  }

  SessionFile& file_;
};

}  // namespace

void ReadSources(SessionFile& file) { SourceReader(file).Read(); }

}  // namespace flextip::live
