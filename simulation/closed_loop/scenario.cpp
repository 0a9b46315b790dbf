#include "simulation/closed_loop/scenario.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"
#include "recording/text/yaml_map.h"
#include "simulation/closed_loop/scenario_sections.h"
#include "simulation/effects/catalogue.h"
#include "task/path_time.h"
#include "task/task_reader.h"

namespace flextip::simulation {
namespace {

constexpr double kLongestHeld_s = 5.0;  // of a supervised run, beyond its path

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
    scenario_.loop.seed = Seed();
    top_.RefuseUnknown();
    for (const YamlMap& section : sections_) section.RefuseUnknown();
    return std::move(scenario_);
  }

 private:
  std::uint64_t Seed() const {
    return static_cast<std::uint64_t>(top_.Has("seed") ? top_.Integer("seed") : 1);
  }

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
    scenario_.loop.sensors = ReadScenarioSensors(
        Section(top_, "sensors"), scenario_.loop.base.instrument.length_m, sections_);
  }

  void ReadCamera() {
    LoopSetup& loop = scenario_.loop;
    if (loop.sensors.tip) loop.update_rate_hz = loop.sensors.tip->rate_hz;
    if (!top_.Has("camera")) return;
    scenario_.laparoscope.seed = Seed();
    ReadScenarioCamera(Section(top_, "camera"), file_.parent_path(), sections_, scenario_);
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
    scenario_.loop.fault_seed = Seed();
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
