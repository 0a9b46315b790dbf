#include <fmt/format.h>
#include <fmt/ranges.h>

#include "control/supervision/jerk_filter.h"
#include "core/error.h"
#include "estimation/shaft_estimator.h"
#include "live/session/address.h"
#include "live/session/plausible.h"
#include "live/session/session_file.h"

namespace flextip::live {
namespace {

constexpr const char* kFormat = "flextip-session";
constexpr std::int64_t kVersion = 1;

class SessionReader {
 public:
  SessionReader(const std::filesystem::path& file, const std::filesystem::path& other_folder)
      : file_{file, other_folder, YamlMap::Load(file), {}, {}} {}

  Session Read() {
    file_.session.file = file_.file;
    CheckFormat();
    ReadInstrument();
    ReadSources(file_);
    ReadRobot();
    ReadController();
    ReadLimits();
    ReadPublish();
    ReadPath();
    ReadCalibrations();
    ReadModel();
    RefuseUnknownKeys();
    if (file_.session.DelayIsUnknown()) {
      file_.session.warnings.emplace_back(
          file_.top.Map("sources")
              .Error("cam0",
                     "has no latency_s: the robot will not be enabled; state how old a "
                     "picture is on arrival, latency_s: {value: ..., sd: ...}")
              .what());
    }
    return std::move(file_.session);
  }

 private:
  void CheckFormat() const {
    if (const std::string found = file_.top.Text("format"); found != kFormat) {
      throw file_.top.Error("format", fmt::format("found '{}', expected {}", found, kFormat));
    }
    if (const std::int64_t found = file_.top.Integer("version"); found != kVersion) {
      throw file_.top.Error("version", fmt::format("found {}, expected {}", found, kVersion));
    }
  }

  void ReadInstrument() {
    const YamlMap map = file_.Section(file_.top, "instrument");
    Instrument& instrument = file_.session.base.instrument;
    instrument.length_m = NumberIn(map, "length_m", kShaftLength);
    instrument.outer_diameter_m = NumberIn(map, "outer_diameter_m", kDiameter);
    instrument.bending_stiffness_Nm2 = NumberIn(map, "bending_stiffness_Nm2", kStiffness);
    instrument.mass_per_length_kg_m = NumberInOr(map, "mass_per_length_kg_m", kMassPerLength, 0.0);
    instrument.stiffness_taper = map.NumberOr("stiffness_taper", 0.0);
    file_.session.base.p_RP = VectorIn(file_.Section(file_.top, "port"), "position_m", kPlace);
    file_.session.port_prior_m =
        NumberInOr(file_.top, "port_registration_m", kNoise, kPortRegistration_m);
    if (file_.top.Has("gravity_m_s2")) {
      file_.session.base.gravity_m_s2 = VectorIn(file_.top, "gravity_m_s2", kGravity);
    }
  }

  std::optional<Address> RobotAddress(const YamlMap& map, const std::string& key, Content content) {
    if (!map.Has(key)) return {};
    const auto address = ReadAddress(file_.Section(map, key), file_.sections, content);
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
    const YamlMap map = file_.Section(file_.top, "robot");
    const auto command = RobotAddress(map, "command", Content::kPose);
    if (!command) throw map.Error("command", "is missing: where do commands go?");
    file_.session.robot.command = *command;
    file_.session.robot.state = RobotAddress(map, "state", Content::kState);
    file_.session.robot.command_state = RobotAddress(map, "command_state", Content::kText);
    file_.session.robot.lockstep = RobotAddress(map, "lockstep", Content::kText);
    ReadTransform(map, "T_RB", file_.session.robot.T_RB);
    ReadTransform(map, "T_DW", file_.session.robot.T_DW);
    if (file_.session.robot.command_state && !file_.session.robot.state) {
      throw map.Error("command_state", "needs state: nobody commands a robot that is not seen");
    }
  }

  void ReadController() {
    const YamlMap map = file_.Section(file_.top, "controller");
    file_.session.rate_hz = NumberIn(map, "rate_hz", kRate);
    TaskReader reader(file_.file.parent_path(), file_.session.task, file_.sections);
    reader.ReadControl(map);
    file_.session.task.supervision.kind = SupervisionKind::kFull;
    reader.ReadSupervisor(file_.top);
    reader.ReadDiagnosis(file_.top);
    RequireIn(map, "max_step_m", kStep, file_.session.task.controller.max_step_m);
    file_.session.task.controller.kind = ReadControllerKind(map, "kind", map.Text("kind"));
    const std::int64_t window = map.Has("window_samples") ? map.Integer("window_samples") : 0;
    if (window < 0 || window > 1000) {
      throw map.Error("window_samples", fmt::format("found {}, expected 0 to 1000", window));
    }
    file_.session.window_samples = static_cast<int>(window);
    const bool seen = file_.session.HasTip() || file_.session.EmIsTip();
    if (UsesTipMeasurement(file_.session.task.controller.kind) && !seen) {
      throw map.Error("kind", fmt::format("found {}, which needs a tip: expected a source cam0, "
                                          "vision0 or em0",
                                          Name(file_.session.task.controller.kind)));
    }
  }

  void ReadLimits() {
    const YamlMap map = file_.Section(file_.top, "limits");
    LimitSetup& limits = file_.session.limits;
    limits.max_step_m = NumberIn(map, "max_step_m", kStep);
    limits.max_speed_m_s = NumberIn(map, "max_speed_m_s", kSpeed);
    limits.max_acceleration_m_s2 = NumberIn(map, "max_acceleration_m_s2", kAcceleration);
    if (map.Has("max_jerk_m_s3")) {
      const double least_m_s3 =
          JerkFilter::LeastJerk(limits.max_acceleration_m_s2, file_.session.rate_hz);
      limits.max_jerk_m_s3 = map.Number("max_jerk_m_s3");
      if (!(limits.max_jerk_m_s3 >= least_m_s3)) {
        throw map.Error("max_jerk_m_s3",
                        fmt::format("found {}, expected at least {:.3g} at this rate and "
                                    "acceleration",
                                    limits.max_jerk_m_s3, least_m_s3));
      }
    }
    limits.resume_after_s = NumberInOr(map, "resume_after_s", kTime, limits.resume_after_s);
    if (map.Has("workspace")) {
      const YamlMap box = file_.Section(map, "workspace");
      limits.workspace =
          WorkspaceBox{VectorIn(box, "lower_m", kPlace), VectorIn(box, "upper_m", kPlace)};
      if ((limits.workspace->lower_m.array() >= limits.workspace->upper_m.array()).any()) {
        throw box.Error("upper_m", "expected every component above lower_m's");
      }
    }
    TaskReader(file_.other_folder.empty() ? file_.file.parent_path() : file_.other_folder,
               file_.session.task, file_.sections)
        .ReadFixtures(map);
  }

  void ReadPublish() {
    if (!file_.top.Has("publish")) return;
    const YamlMap map = file_.Section(file_.Section(file_.top, "publish"), "openigtlink");
    PublishSetup& publish = file_.session.publish.emplace();
    const std::int64_t port = map.Integer("port");
    if (port < 1 || port > 65535)
      throw map.Error("port", fmt::format("found {}, expected 1 to 65535", port));
    publish.port = static_cast<int>(port);
    publish.any_address = ReadChoice(map, "address", {"127.0.0.1", "any"}) == 1;
    publish.rate_hz = NumberInOr(map, "rate_hz", kRate, publish.rate_hz);
  }

  void ReadPath() {
    TaskReader reader(file_.file.parent_path(), file_.session.task, file_.sections);
    const YamlMap controller = file_.top.Map("controller");
    if (!file_.top.Has("path")) {
      reader.FinishDirection(controller, controller, "kind", {file_.session.task.controller.kind});
      return;
    }
    const YamlMap map = reader.PathSection(file_.top);
    PathPlace& place = file_.session.path.emplace();
    const bool in_robot_frame = reader.ReadPathFrame(map) == PathFrame::kRobot;
    place.average_s = NumberInOr(map, "average_s", kTime, place.average_s);
    if (map.Has("start_m")) {
      if (!in_robot_frame) {
        throw map.Error("start_m", "needs frame: R");
      }
      place.p_start = VectorIn(map, "start_m", kPlace);
    }
    if (map.Has("goal")) {
      ReadGoal(map);
      reader.FinishDirection(controller, controller, "kind", {file_.session.task.controller.kind});
      return;
    }
    reader.ReadPath(map);
    const Plausible& range = in_robot_frame ? kPlace : kWay;
    for (const auto& waypoint : file_.session.task.path.waypoints_m) {
      RequireIn(map, "waypoints", range, waypoint.norm());
    }
    RequireIn(map, "speed_m_s", kSpeed, file_.session.task.path.speed_m_s);
    reader.FinishDirection(controller, controller, "kind", {file_.session.task.controller.kind});
  }

  void ReadGoal(const YamlMap& map) {
    file_.session.goal = ReadAddress(file_.Section(map, "goal"), file_.sections, Content::kPose);
    if (!file_.session.goal)
      throw map.Error("goal", fmt::format("found no source, expected {}", ProtocolKeys()));
    PathSetup& path = file_.session.task.path;
    path.speed_m_s = map.PositiveOr("speed_m_s", path.speed_m_s);
    RequireIn(map, "speed_m_s", kSpeed, path.speed_m_s);
  }

  void ReadCalibrations() {
    file_.session.uncalibrated = file_.session.base;
    if (!file_.top.Has("calibrations")) return;
    std::vector<std::filesystem::path> files;
    for (const std::string& name : file_.top.Texts("calibrations"))
      files.push_back(file_.Beside(name));
    file_.session.calibrations =
        ApplyCalibrations(files, file_.session.base, file_.session.warnings);
    if (file_.session.camera) ReadCameraClocks(*file_.session.camera);
  }

  void ReadCameraClocks(CameraSetup& camera) {
    for (const UsedCalibration& used : file_.session.calibrations) {
      const auto clock = ClockIn(used.calibration, "cam0");
      if (!clock) continue;
      camera.clocks.push_back(*clock);
      camera.latency_known = true;
    }
  }

  void ReadModel() {
    if (file_.top.Has("model"))
      file_.session.model = diagnosis::ReadModel(file_.Beside(file_.top.Text("model")));
  }

  void RefuseUnknownKeys() const {
    (void)file_.top.Has("comment");
    file_.top.RefuseUnknown();
    for (const YamlMap& section : file_.sections) section.RefuseUnknown();
  }

  SessionFile file_;
};

}  // namespace

Session ReadSession(const std::filesystem::path& file, const std::filesystem::path& other_folder) {
  return SessionReader(file, other_folder).Read();
}

}  // namespace flextip::live
