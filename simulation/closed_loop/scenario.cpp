#include "simulation/closed_loop/scenario.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"
#include "recording/cameras/camera_file.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/yaml_map.h"
#include "simulation/effects/catalogue.h"
#include "task/path_time.h"
#include "task/task_reader.h"

namespace flextip::simulation {
namespace {

constexpr double kLongestHeld_s = 5.0;  // of a supervised run, beyond its path

Eigen::Vector3d VectorOr(const YamlMap& map, const std::string& key,
                         const Eigen::Vector3d& fallback) {
  return map.Has(key) ? map.Vector3(key) : fallback;
}

/// Reads a file's sections and remembers them, to find the keys nobody asked for.
class ScenarioReader {
 public:
  explicit ScenarioReader(const std::filesystem::path& file)
      : file_(file), top_(YamlMap::Load(file)) {}

  Scenario Read() {
    ReadInstrument();
    ReadWrist();
    CheckReach();
    ReadLoad();
    ReadSensors();
    ReadCamera();
    ReadEffects();
    ReadTask();
    ReadFaults();
    scenario_.loop.seed = static_cast<std::uint64_t>(top_.Has("seed") ? top_.Integer("seed") : 1);
    top_.RefuseUnknown();
    for (const YamlMap& section : sections_) section.RefuseUnknown();
    return std::move(scenario_);
  }

 private:
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections_.push_back(map.Map(key));
    return sections_.back();
  }

  void ReadInstrument() {
    const YamlMap map = Section(top_, "instrument");
    Instrument& instrument = scenario_.loop.base.instrument;
    instrument.length_m = map.Positive("length_m");
    instrument.outer_diameter_m = map.Positive("outer_diameter_m");
    instrument.bending_stiffness_Nm2 = map.Positive("bending_stiffness_Nm2");
    instrument.mass_per_length_kg_m = map.NonNegativeOr("mass_per_length_kg_m", 0.0);
    scenario_.loop.base.p_RP = Section(top_, "port").Vector3("position_m");
    scenario_.loop.base.gravity_m_s2 = VectorOr(top_, "gravity_m_s2", {0.0, 0.0, -9.81});
    scenario_.loop.port_prior_m = top_.PositiveOr("port_registration_m", kPortRegistration_m);

    PlantSetup& plant = scenario_.loop.plant;
    plant.instrument = instrument;
    plant.p_RP = scenario_.loop.base.p_RP;
    plant.weight_N_m = instrument.mass_per_length_kg_m * scenario_.loop.base.gravity_m_s2;
    plant.roll_rad = top_.NumberOr("roll_rad", 0.0);
  }

  void ReadWrist() {
    const YamlMap map = Section(top_, "wrist");
    scenario_.loop.p_RW_start = map.Vector3("start_m");
    WristServoSetup& servo = scenario_.loop.servo;
    servo.max_speed_m_s = map.PositiveOr("max_speed_m_s", servo.max_speed_m_s);
    servo.lag_s = map.NonNegativeOr("lag_s", 0.0);
    if (map.Has("servo_rate_hz")) servo.rate_hz = map.Positive("servo_rate_hz");
    servo.lost = map.NonNegativeOr("lost_commands", 0.0);
    if (servo.lost >= 1.0) {
      throw map.Error("lost_commands", fmt::format("found {}, expected below 1", servo.lost));
    }
  }

  void ReadLoad() {
    if (!top_.Has("load")) return;
    const YamlMap map = Section(top_, "load");
    TipLoad& load = scenario_.loop.plant.load;
    load.constant_N = VectorOr(map, "force_N", Eigen::Vector3d::Zero());
    if (!map.Has("tissue")) return;
    const YamlMap tissue = Section(map, "tissue");
    Tissue& t = load.tissue.emplace();
    t.p_surface = tissue.Vector3("point_m");
    t.normal = ReadUnit(tissue, "normal");
    t.stiffness_N_m = tissue.NonNegative("stiffness_N_m");
    t.tangential_stiffness_N_m = tissue.NonNegativeOr("tangential_stiffness_N_m", 0.0);
    t.p_anchor = VectorOr(tissue, "anchor_m", t.p_surface);
    t.onset_m = tissue.PositiveOr("onset_m", 0.001);
  }

  void ReadSensors() {
    const YamlMap map = Section(top_, "sensors");
    SensorSetup& sensors = scenario_.loop.sensors;
    const YamlMap wrist = Section(map, "wrist");
    sensors.wrist.emplace();
    sensors.wrist->comment = "wrist encoders";
    sensors.wrist->rate_hz = wrist.Positive("rate_hz");
    sensors.wrist->position_noise_m = wrist.NonNegative("position_noise_m");
    sensors.wrist->orientation_noise_rad = wrist.NonNegative("orientation_noise_rad");
    if (map.Has("em0")) sensors.em0 = ReadEm(Section(map, "em0"), false);
    if (map.Has("em1")) sensors.em1 = ReadEm(Section(map, "em1"), true);
    if (map.Has("strain")) ReadStrain(Section(map, "strain"), sensors.strain.emplace());
    if (map.Has("load")) {
      const YamlMap load = Section(map, "load");
      sensors.load.emplace();
      sensors.load->comment = "load cell on the tip";
      sensors.load->rate_hz = load.Positive("rate_hz");
      sensors.load->force_noise_N = load.NonNegative("force_noise_N");
    }
    if (map.Has("tip")) ReadTip(Section(map, "tip"), sensors.tip.emplace());
  }

  EmStream ReadEm(const YamlMap& map, bool on_port) {
    EmStream em;
    em.comment = on_port ? "EM sensor on the port" : "EM sensor on the shaft";
    em.rate_hz = map.Positive("rate_hz");
    em.orientation_noise_rad = map.NonNegative("orientation_noise_rad");
    em.position_noise_m =
        on_port ? map.NonNegativeOr("position_noise_m", 0.0) : map.NonNegative("position_noise_m");
    if (!on_port) {
      em.distance_from_tip_m = map.NonNegative("distance_from_tip_m");
      if (em.distance_from_tip_m > scenario_.loop.base.instrument.length_m) {
        throw map.Error("distance_from_tip_m", "the sensor is beyond the shaft's wrist end");
      }
    }
    const std::string distribution = map.TextOr("noise_distribution", "gaussian");
    if (distribution != "gaussian" && distribution != "uniform") {
      throw map.Error("noise_distribution",
                      fmt::format("found '{}', expected gaussian or uniform", distribution));
    }
    em.noise_distribution =
        distribution == "uniform" ? NoiseDistribution::kUniform : NoiseDistribution::kGaussian;
    return em;
  }

  void ReadStrain(const YamlMap& map, StrainStream& strain) {
    strain.comment = "strain gages";
    strain.rate_hz = map.Positive("rate_hz");
    strain.moment_noise_Nm = map.NonNegative("moment_noise_Nm");
    const auto stations = map.Numbers("stations_from_wrist_m", 2);
    const double length = scenario_.loop.base.instrument.length_m;
    if (!(0 <= stations[0] && stations[0] < stations[1] && stations[1] <= length)) {
      throw map.Error("stations_from_wrist_m",
                      fmt::format("found {} and {}, expected two places along the shaft of {} m",
                                  stations[0], stations[1], length));
    }
    std::copy(stations.begin(), stations.end(), strain.station_from_wrist_m);
  }

  void ReadTip(const YamlMap& map, TipSensorSetup& tip) {
    tip.across_noise_m = map.NonNegative("across_noise_m");
    tip.depth_noise_m = map.NonNegative("depth_noise_m");
    tip.direction_noise_rad = map.NonNegative("direction_noise_rad");
    if (map.Has("line_of_sight")) tip.line_of_sight = ReadUnit(map, "line_of_sight");
    tip.rate_hz = map.Has("rate_hz") ? map.Positive("rate_hz") : 30.0;
  }

  /// Camera and collar are files in a recording's own format, named relative to the scenario.
  void ReadCamera() {
    LoopSetup& loop = scenario_.loop;
    if (loop.sensors.tip) loop.update_rate_hz = loop.sensors.tip->rate_hz;
    if (!top_.Has("camera")) return;
    const YamlMap map = Section(top_, "camera");
    ReadLog log;
    const auto folder = file_.parent_path();
    loop.base.cam0.emplace();
    loop.base.cam0->comment = "rendered laparoscope";
    loop.base.cam0->calibration = ReadCameraCalibration(folder / map.Text("calibration"), &log);
    loop.base.tags0 = ReadTags(folder / map.Text("collar"), log);
    scenario_.warnings.insert(scenario_.warnings.end(), log.warnings.begin(), log.warnings.end());
    if (map.Has("rate_hz")) loop.base.cam0->calibration.rate_hz = map.Positive("rate_hz");
    loop.update_rate_hz = loop.base.cam0->calibration.rate_hz;
    if (loop.sensors.tip) {
      loop.sensors.tip->rate_hz = loop.update_rate_hz;
      loop.sensors.tip->T_RC = loop.base.cam0->calibration.T_RC;
    }
    scenario_.has_camera = true;

    LaparoscopeOptions& scope = scenario_.laparoscope;
    scope.seed = static_cast<std::uint64_t>(top_.Has("seed") ? top_.Integer("seed") : 1);
    scope.exposure = map.PositiveOr("exposure", scope.exposure);
    scope.blur_sigma_px = map.NonNegativeOr("blur_sigma_px", scope.blur_sigma_px);
    scope.full_well_electrons = map.NonNegativeOr("full_well_electrons", scope.full_well_electrons);
    scope.read_noise_electrons =
        map.NonNegativeOr("read_noise_electrons", scope.read_noise_electrons);
    scope.tissue.relief_m = map.NonNegativeOr("tissue_relief_m", scope.tissue.relief_m);
    if (map.Has("tissue_point_m")) scope.tissue.point_R = map.Vector3("tissue_point_m");
    if (map.Has("tissue_normal")) scope.tissue.normal_R = ReadUnit(map, "tissue_normal");
    if (map.Has("occluders")) {
      for (const YamlMap& occluder : map.Maps("occluders")) ReadOccluder(occluder);
    }
    scenario_.tracker.detector.quad_decimate = map.PositiveOr("quad_decimate", 1.0);
  }

  void ReadOccluder(const YamlMap& map) {
    sections_.push_back(map);
    Occluder occluder;
    const std::string kind = map.Text("kind");
    if (kind != "capsule" && kind != "disc") {
      throw map.Error("kind", fmt::format("found '{}', expected capsule or disc", kind));
    }
    occluder.kind = kind == "disc" ? Occluder::Kind::kDisc : Occluder::Kind::kCapsule;
    occluder.a_R = map.Vector3("a_m");
    occluder.b_R = map.Vector3("b_m");
    occluder.radius_m = map.Positive("radius_m");
    occluder.velocity_R = VectorOr(map, "velocity_m_per_frame", Eigen::Vector3d::Zero());
    if (map.Has("metal") && map.Number("metal") > 0) {
      occluder.albedo_bgr = {0.5, 0.5, 0.5};
      occluder.specular = 1.0;
    }
    if (map.Has("first_frame")) occluder.first_frame = static_cast<int>(map.Integer("first_frame"));
    if (map.Has("last_frame")) occluder.last_frame = static_cast<int>(map.Integer("last_frame"));
    scenario_.laparoscope.occluders.push_back(occluder);
  }

  /// effects: {NAME: {PARAMETER: number or list}}, of plant and sensors.
  void ReadEffects() {
    if (!top_.Has("effects")) return;
    const YamlMap map = Section(top_, "effects");
    LoopSetup& loop = scenario_.loop;
    EffectValues values;
    const Eigen::Vector3d to_port = (loop.base.p_RP - loop.p_RW_start).normalized();
    Eigen::Vector3d em_centre = loop.p_RW_start + loop.base.instrument.length_m * to_port;
    for (const std::string& name : map.Keys()) {
      const YamlMap effect = Section(map, name);
      if (name == "em_distortion") em_centre = VectorOr(effect, "centre_m", em_centre);
      for (const std::string& key : effect.Keys()) {
        if (name == "em_distortion" && key == "centre_m") continue;
        values[name][key] =
            effect.IsList(key) ? effect.Numbers(key) : std::vector<double>{effect.Number(key)};
      }
      CheckEffect(map, name, values);
    }
    const InstrumentEffects effects = EffectsOfWholeMass(values, loop.base.instrument);
    loop.plant.effects = effects.plant;
    loop.plant.gravity_m_s2 = loop.base.gravity_m_s2;
    loop.sensor_effects = effects.sensors;
    loop.sensor_effects.em_centre_m = em_centre;
    if (*WhatIsWrong(loop.plant) != '\0') throw top_.Error("effects", WhatIsWrong(loop.plant));
  }

  /// So that a complaint names the line.
  void CheckEffect(const YamlMap& map, const std::string& name, const EffectValues& values) const {
    const bool of_camera = name == "hand_eye" || name == "focal_length";
    if (of_camera && !scenario_.has_camera) throw map.Error(name, "needs a section camera");
    try {
      EffectsOfWholeMass(values, scenario_.loop.base.instrument);
    } catch (const InputError& error) {
      throw map.Error(name, error.what());
    }
  }

  /// The sections path, controllers, control and fixtures.
  void ReadTask() {
    TipTask task;
    TaskReader reader(file_.parent_path(), task, sections_);
    reader.ReadPath(reader.PathSection(top_));
    ReadControllers();
    std::optional<YamlMap> control;
    if (top_.Has("control")) control = Section(top_, "control");
    reader.ReadSupervisor(top_);
    reader.ReadDiagnosis(top_);
    if (control) {
      reader.ReadControl(*control);
      ReadTimes(*control);
    }
    reader.ReadFixtures(top_);
    reader.FinishDirection(control ? *control : top_, top_, "controllers", scenario_.controllers);
    LoopSetup& loop = scenario_.loop;
    loop.path = std::move(task.path);
    loop.controller = task.controller;
    loop.supervision = task.supervision;
    loop.supervision.rate_hz = loop.update_rate_hz;
    loop.direction = task.direction;
    loop.direction_free_axis = task.direction_free_axis;
    loop.fixtures = std::move(task.fixtures);
    if (task.watch.running) Watch(task.watch);
    // A loop that is held does not come to its path's end.
    if (loop.supervision.kind != SupervisionKind::kNone)
      loop.max_s = PathSeconds(loop) + kLongestHeld_s;
  }

  void Watch(const WatchTask& watch) {
    LoopSetup& loop = scenario_.loop;
    const diagnosis::RunningOptions options{watch.false_alarms_per_hour, loop.port_prior_m};
    loop.watch = [base = loop.base, options] {
      return std::make_unique<diagnosis::RunningDiagnosis>(base, options);
    };
  }

  /// faults: what goes wrong while the loop runs, which nobody is told of.
  void ReadFaults() {
    if (!top_.Has("faults")) return;
    for (const YamlMap& map : top_.Maps("faults")) {
      sections_.push_back(map);
      const std::string kind = map.Text("kind"), of = map.Text("of");
      const auto found = FaultKindNamed(kind);
      const auto stream = FaultStreamNamed(of);
      if (!found) throw map.Error("kind", fmt::format("found '{}', which is no fault", kind));
      if (!stream || !CanHave(*stream, *found)) {
        throw map.Error("of", fmt::format("found '{}', which cannot have the fault {}", of, kind));
      }
      scenario_.loop.faults.push_back({*found, *stream, map.NonNegative("start_s"),
                                       map.NonNegativeOr("duration_s", kLongestPath_s),
                                       map.NumberOr("size", 0.0)});
    }
    scenario_.loop.fault_seed =
        static_cast<std::uint64_t>(top_.Has("seed") ? top_.Integer("seed") : 1);
  }

  /// The controller's rate, and the latencies that it is told of.
  void ReadTimes(const YamlMap& control) {
    LoopSetup& loop = scenario_.loop;
    loop.update_rate_hz = control.PositiveOr("rate_hz", loop.update_rate_hz);
    if (control.Has("tip_latency_s")) loop.tip_latency = ReadLatency(control, "tip_latency_s");
    if (control.Has("em0_latency_s")) loop.em0_latency = ReadLatency(control, "em0_latency_s");
  }

  Latency ReadLatency(const YamlMap& map, const std::string& key) {
    const YamlMap latency = Section(map, key);
    return {latency.NonNegative("value"), latency.NonNegativeOr("sd", 0.0)};
  }

  void ReadControllers() {
    std::vector<ControllerKind>& kinds = scenario_.controllers;
    if (top_.IsList("controllers")) {
      for (const std::string& name : top_.Texts("controllers")) AddController(name);
    } else if (top_.Text("controllers") == "all") {
      for (int i = 0; i < kControllerKinds; ++i) kinds.push_back(static_cast<ControllerKind>(i));
    } else {
      AddController(top_.Text("controllers"));
    }
  }

  void AddController(const std::string& name) {
    scenario_.controllers.push_back(ReadControllerKind(top_, "controllers", name, "all"));
  }

  void CheckReach() const {
    const double distance = (scenario_.loop.p_RW_start - scenario_.loop.base.p_RP).norm();
    const double length = scenario_.loop.base.instrument.length_m;
    if (distance < length && distance > 0) return;
    throw top_.Map("wrist").Error(
        "start_m",
        fmt::format("the port is {:.6g} m from the wrist, out of reach of a shaft of {} m",
                    distance, length));
  }

  std::filesystem::path file_;
  YamlMap top_;
  std::vector<YamlMap> sections_;
  Scenario scenario_;
};

}  // namespace

double PathSeconds(const LoopSetup& loop) {
  const Eigen::Vector3d to_port = (loop.base.p_RP - loop.p_RW_start).normalized();
  const Eigen::Vector3d p_straight = loop.p_RW_start + loop.base.instrument.length_m * to_port;
  return PathSeconds(loop.path, loop.update_rate_hz, p_straight);
}

Scenario ReadScenario(const std::filesystem::path& file) { return ScenarioReader(file).Read(); }

}  // namespace flextip::simulation
