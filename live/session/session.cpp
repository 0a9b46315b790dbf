#include "live/session/session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/error.h"
#include "estimation/shaft_estimator.h"
#include "live/session/address.h"
#include "live/session/plausible.h"
#include "recording/cameras/camera_file.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {
namespace {

constexpr const char* kFormat = "flextip-session";
constexpr std::int64_t kVersion = 1;

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

/// Reads a file's sections and remembers them, to find the keys nobody asked for.
class SessionReader {
 public:
  SessionReader(const std::filesystem::path& file, std::filesystem::path other_folder)
      : file_(file), other_folder_(std::move(other_folder)), top_(YamlMap::Load(file)) {}

  Session Read() {
    session_.file = file_;
    CheckFormat();
    ReadInstrument();
    ReadSources();
    ReadRobot();
    ReadController();
    ReadLimits();
    ReadPublish();
    ReadPath();
    ReadCalibrations();
    ReadModel();
    RejectUnknownKeys();
    if (session_.DelayIsUnknown()) {
      session_.warnings.push_back(
          top_.Map("sources")
              .Error("cam0",
                     "has no latency_s: the robot will not be enabled; state how old a "
                     "picture is on arrival, latency_s: {value: ..., sd: ...}")
              .what());
    }
    return std::move(session_);
  }

 private:
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections_.push_back(map.Map(key));
    return sections_.back();
  }
  std::filesystem::path Beside(const std::string& name) {
    session_.named_files.emplace_back(name);
    const std::filesystem::path beside = file_.parent_path() / name;
    if (other_folder_.empty() || std::filesystem::exists(beside)) return beside;
    return other_folder_ / name;
  }

  void CheckFormat() const {
    if (const std::string found = top_.Text("format"); found != kFormat) {
      throw top_.Error("format", fmt::format("found '{}', expected {}", found, kFormat));
    }
    if (const std::int64_t found = top_.Integer("version"); found != kVersion) {
      throw top_.Error("version", fmt::format("found {}, expected {}", found, kVersion));
    }
  }

  void ReadInstrument() {
    const YamlMap map = Section(top_, "instrument");
    Instrument& instrument = session_.base.instrument;
    instrument.length_m = NumberIn(map, "length_m", kShaftLength);
    instrument.outer_diameter_m = NumberIn(map, "outer_diameter_m", kDiameter);
    instrument.bending_stiffness_Nm2 = NumberIn(map, "bending_stiffness_Nm2", kStiffness);
    instrument.mass_per_length_kg_m = NumberInOr(map, "mass_per_length_kg_m", kMassPerLength, 0.0);
    instrument.stiffness_taper = map.NumberOr("stiffness_taper", 0.0);
    session_.base.p_RP = VectorIn(Section(top_, "port"), "position_m", kPlace);
    session_.port_prior_m = NumberInOr(top_, "port_registration_m", kNoise, kPortRegistration_m);
    if (top_.Has("gravity_m_s2")) {
      session_.base.gravity_m_s2 = VectorIn(top_, "gravity_m_s2", kGravity);
    }
  }

  /// Everything a stream has but its noises. Empty where `sources` has no such stream.
  std::optional<YamlMap> ReadStream(const YamlMap& sources, StreamName stream,
                                    double default_stale_s) {
    const std::string key = Name(stream);
    if (!sources.Has(key)) return {};
    const YamlMap map = Section(sources, key);
    StreamSetup& setup = session_.streams[static_cast<std::size_t>(stream)].emplace();
    const auto address = ReadAddress(map, sections_, ContentOf(stream));
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
    const YamlMap section = Section(map, "latency_s");
    latency.value_s = NumberIn(section, "value", kTime);
    latency.sd_s = NumberInOr(section, "sd", kTime, 0.0);
    return latency;
  }

  double RateOf(const YamlMap& map) const { return NumberInOr(map, "rate_hz", kRate, 100.0); }

  void ReadSources() {
    const YamlMap sources = Section(top_, "sources");
    Recording& base = session_.base;
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
    if (sources.Has("cam0")) ReadCamera(Section(sources, "cam0"), sources);
  }

  std::string Comment(StreamName stream) const {
    return fmt::format("live, {}", Text(session_.Of(stream)->address));
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
      const double length = session_.base.instrument.length_m;
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
    StrainStream& strain = session_.base.strain0.emplace();
    strain.comment = Comment(StreamName::kStrain);
    strain.rate_hz = RateOf(map);
    strain.moment_noise_Nm = NumberIn(map, "moment_noise_Nm", kMomentNoise);
    const auto s = map.Numbers("stations_from_wrist_m", 2);
    const double length = session_.base.instrument.length_m;
    if (!(0 <= s[0] && s[0] < s[1] && s[1] <= length)) {
      throw map.Error("stations_from_wrist_m",
                      fmt::format("found [{}, {}], expected 0 <= s1 < s2 <= the shaft's length {}",
                                  s[0], s[1], length));
    }
    strain.station_from_wrist_m[0] = s[0];
    strain.station_from_wrist_m[1] = s[1];
  }

  void ReadCamera(const YamlMap& map, const YamlMap& sources) {
    if (session_.Of(StreamName::kTip)) {
      throw sources.Error("cam0", "found a camera and vision0, expected one of them");
    }
    CameraSetup& camera = session_.camera.emplace();
    camera.address = ReadAddress(map, sections_, Content::kPicture);
    camera.video = map.TextOr("video", "");
    if (camera.address.has_value() == !camera.video.empty()) {
      throw sources.Error("cam0", "expected one source: video or openigtlink");
    }
    camera.latency = ReadLatency(map);
    camera.latency_known = map.Has("latency_s");
    camera.stale_s = NumberInOr(map, "stale_s", kStale, camera.stale_s);
    ReadLog log;
    CameraStream& stream = session_.base.cam0.emplace();
    stream.comment = "live camera";
    stream.calibration = ReadCameraCalibration(Beside(map.Text("sensor")), &log);
    session_.base.tags0 = ReadCollarFile(Beside(map.Text("collar")), log);
    session_.warnings.insert(session_.warnings.end(), log.warnings.begin(), log.warnings.end());
    VisionStream& vision = session_.base.vision0.emplace();
    vision.comment = "tip by vision, as the cycle was given it";
    vision.rate_hz = stream.calibration.rate_hz;
  }

  std::optional<Address> RobotAddress(const YamlMap& map, const std::string& key, Content content) {
    if (!map.Has(key)) return {};
    const auto address = ReadAddress(Section(map, key), sections_, content);
    if (!address || !address->protocol->takes_commands) {
      throw map.Error(key, "found no peer that takes commands, as openigtlink and ros2 do");
    }
    return address;
  }

  static void ReadTransform(const YamlMap& map, const std::string& key, Pose& T) {
    if (!map.Has(key)) return;
    T = map.Transform(key);
    RequireIn(map, key, kPlace, T.p.norm());
  }

  void ReadRobot() {
    const YamlMap map = Section(top_, "robot");
    const auto command = RobotAddress(map, "command", Content::kPose);
    if (!command) throw map.Error("command", "is missing: where do commands go?");
    session_.robot.command = *command;
    session_.robot.state = RobotAddress(map, "state", Content::kState);
    session_.robot.command_state = RobotAddress(map, "command_state", Content::kText);
    session_.robot.lockstep = RobotAddress(map, "lockstep", Content::kText);
    ReadTransform(map, "T_RB", session_.robot.T_RB);
    ReadTransform(map, "T_DW", session_.robot.T_DW);
    if (session_.robot.command_state && !session_.robot.state) {
      throw map.Error("command_state", "needs state: nobody commands a robot that is not seen");
    }
  }

  void ReadController() {
    const YamlMap map = Section(top_, "controller");
    session_.rate_hz = NumberIn(map, "rate_hz", kRate);
    TaskReader reader(file_.parent_path(), session_.task, sections_);
    reader.ReadControl(map);
    RequireIn(map, "max_step_m", kStep, session_.task.controller.max_step_m);
    session_.task.controller.kind = ReadControllerKind(map, "kind", map.Text("kind"));
    const std::int64_t window = map.Has("window_samples") ? map.Integer("window_samples") : 0;
    if (window < 0 || window > 1000) {
      throw map.Error("window_samples", fmt::format("found {}, expected 0 to 1000", window));
    }
    session_.window_samples = static_cast<int>(window);
    const bool seen = session_.HasTip() || session_.EmIsTip();
    if (UsesTipMeasurement(session_.task.controller.kind) && !seen) {
      throw map.Error("kind", fmt::format("found {}, which needs a tip: expected a source cam0, "
                                          "vision0 or em0",
                                          Name(session_.task.controller.kind)));
    }
  }

  void ReadLimits() {
    const YamlMap map = Section(top_, "limits");
    LimitSetup& limits = session_.limits;
    limits.max_step_m = NumberIn(map, "max_step_m", kStep);
    limits.max_speed_m_s = NumberIn(map, "max_speed_m_s", kSpeed);
    limits.max_acceleration_m_s2 = NumberIn(map, "max_acceleration_m_s2", kAcceleration);
    limits.resume_after_s = NumberInOr(map, "resume_after_s", kTime, limits.resume_after_s);
    if (map.Has("workspace")) {
      const YamlMap box = Section(map, "workspace");
      limits.workspace = Box{VectorIn(box, "lower_m", kPlace), VectorIn(box, "upper_m", kPlace)};
      if ((limits.workspace->lower_m.array() >= limits.workspace->upper_m.array()).any()) {
        throw box.Error("upper_m", "expected every component above lower_m's");
      }
    }
    TaskReader(other_folder_.empty() ? file_.parent_path() : other_folder_, session_.task,
               sections_)
        .ReadFixtures(map);
  }

  void ReadPublish() {
    if (!top_.Has("publish")) return;
    const YamlMap map = Section(Section(top_, "publish"), "openigtlink");
    PublishSetup& publish = session_.publish.emplace();
    const std::int64_t port = map.Integer("port");
    if (port < 1 || port > 65535)
      throw map.Error("port", fmt::format("found {}, expected 1 to 65535", port));
    publish.port = static_cast<int>(port);
    publish.any_address = ReadChoice(map, "address", {"127.0.0.1", "any"}) == 1;
    publish.rate_hz = NumberInOr(map, "rate_hz", kRate, publish.rate_hz);
  }

  void ReadPath() {
    TaskReader reader(file_.parent_path(), session_.task, sections_);
    const YamlMap controller = top_.Map("controller");
    if (!top_.Has("path")) {
      reader.FinishDirection(controller, controller, "kind", {session_.task.controller.kind});
      return;
    }
    const YamlMap map = Section(top_, "path");
    PathPlace& place = session_.path.emplace();
    place.frame =
        ReadChoice(map, "frame", {"start", "R"}) == 1 ? PathFrame::kRobot : PathFrame::kStart;
    place.average_s = NumberInOr(map, "average_s", kTime, place.average_s);
    if (map.Has("start_m")) {
      if (place.frame != PathFrame::kRobot) {
        throw map.Error("start_m", "needs frame: R");
      }
      place.p_start = VectorIn(map, "start_m", kPlace);
    }
    if (map.Has("goal")) {
      ReadGoal(map);
      reader.FinishDirection(controller, controller, "kind", {session_.task.controller.kind});
      return;
    }
    reader.ReadPath(map);
    const Plausible& range = place.frame == PathFrame::kRobot ? kPlace : kWay;
    for (const auto& waypoint : session_.task.path.waypoints_m) {
      RequireIn(map, "waypoints", range, waypoint.norm());
    }
    RequireIn(map, "speed_m_s", kSpeed, session_.task.path.speed_m_s);
    reader.FinishDirection(controller, controller, "kind", {session_.task.controller.kind});
  }

  void ReadGoal(const YamlMap& map) {
    session_.goal = ReadAddress(Section(map, "goal"), sections_, Content::kPose);
    if (!session_.goal)
      throw map.Error("goal", fmt::format("found no source, expected {}", ProtocolKeys()));
    PathSetup& path = session_.task.path;
    path.speed_m_s = map.PositiveOr("speed_m_s", path.speed_m_s);
    RequireIn(map, "speed_m_s", kSpeed, path.speed_m_s);
  }

  void ReadCalibrations() {
    session_.uncalibrated = session_.base;
    if (!top_.Has("calibrations")) return;
    std::vector<std::filesystem::path> files;
    for (const std::string& name : top_.Texts("calibrations")) files.push_back(Beside(name));
    session_.calibrations = ApplyCalibrations(files, session_.base, session_.warnings);
    if (session_.camera) ReadCameraClocks(*session_.camera);
  }

  void ReadCameraClocks(CameraSetup& camera) {
    for (const UsedCalibration& used : session_.calibrations) {
      const auto clock = ClockIn(used.calibration, "cam0");
      if (!clock) continue;
      camera.clocks.push_back(*clock);
      camera.latency_known = true;
    }
  }

  void ReadModel() {
    if (top_.Has("model")) session_.model = diagnosis::ReadModel(Beside(top_.Text("model")));
  }

  void RejectUnknownKeys() const {
    ReadLog log;
    (void)top_.Has("comment");
    top_.WarnUnknown(log);
    for (const YamlMap& section : sections_) section.WarnUnknown(log);
    if (log.warnings.empty()) return;
    const std::string& first = log.warnings.front();
    throw InputError(first.substr(0, first.rfind(" ignored")));
  }

  std::filesystem::path file_, other_folder_;
  YamlMap top_;
  std::vector<YamlMap> sections_;
  Session session_;
};

}  // namespace

const char* Name(StreamName stream) {
  constexpr std::array names{"wrist0", "vision0", "em0", "em1", "strain0", "load0"};
  return names[static_cast<std::size_t>(stream)];
}

TimeNs CameraSetup::TimeOf(TimeNs t_ns) const {
  t_ns -= std::llround(1e9 * latency.value_s);
  for (const FoundClock& clock : clocks) t_ns = clock.TimeOf(t_ns);
  return t_ns;
}

Latency Session::LatencyOf(StreamName stream) const {
  if (const auto& setup = Of(stream)) return setup->latency;
  if (stream != StreamName::kTip || !camera) return {};
  Latency latency = camera->latency;
  if (camera->address) return latency;
  for (const FoundClock& clock : camera->clocks)
    latency.value_s -= 1e-9 * static_cast<double>(clock.offset_ns);
  return latency;
}

double Session::TimeSdOf(StreamName stream, TimeNs t_ns) const {
  const double sd_s = LatencyOf(stream).sd_s;
  const auto with = [&](const auto& of) {
    return of ? std::hypot(sd_s, of->clock.SdAt(t_ns)) : sd_s;
  };
  if (stream == StreamName::kWrist) return with(base.wrist0);
  if (stream == StreamName::kTip) return with(base.vision0);
  if (stream == StreamName::kEm0) return with(base.em0);
  return sd_s;
}

bool Session::DelayIsUnknown() const {
  if (!path || !UsesTipMeasurement(task.controller.kind)) return false;
  return camera && !camera->address && !camera->latency_known;
}

Session ReadSession(const std::filesystem::path& file, const std::filesystem::path& other_folder) {
  return SessionReader(file, other_folder).Read();
}

}  // namespace flextip::live
