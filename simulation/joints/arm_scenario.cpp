#include "simulation/joints/arm_scenario.h"

#include <fmt/format.h>

#include <map>
#include <string>

#include "recording/arm/arm_file.h"
#include "recording/text/yaml_map.h"

namespace flextip::simulation {
namespace {

constexpr double kMostRows = 1e6;
constexpr double kUsualLag_s = 1e-3, kLongest_s = 1.0;

class Reader {
 public:
  Reader(const std::filesystem::path& file, ReadLog& log)
      : file_(file), log_(log), top_(YamlMap::Load(file)) {}

  ArmScenario Read() {
    ReadTheArm();
    ReadMotion();
    ReadSensors();
    ReadEffects();
    top_.RefuseUnknown();
    for (const YamlMap& section : sections_) section.RefuseUnknown();
    return std::move(scenario_);
  }

 private:
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections_.push_back(map.Map(key));
    return sections_.back();
  }
  int Joints() const { return scenario_.arm.Size(); }

  void ReadTheArm() {
    if (!top_.IsText("arm"))
      throw top_.Error("arm", "found no file of an arm: this may be a scenario of flextip map");
    scenario_.arm = ReadArm(file_.parent_path() / top_.Text("arm"), log_);
    if (scenario_.arm.links.empty())
      throw top_.Error("arm", "the file states no masses of links: forces cannot move the arm");
  }

  void ReadMotion() {
    ArmMotion& motion = scenario_.motion;
    motion.seed = static_cast<std::uint64_t>(top_.Has("seed") ? top_.Integer("seed") : 1);
    if (!top_.Has("motion")) return;
    const YamlMap map = Section(top_, "motion");
    motion.seconds = map.PositiveOr("seconds", motion.seconds);
    motion.rate_hz = map.PositiveOr("rate_hz", motion.rate_hz);
    motion.fastest_hz = map.PositiveOr("fastest_hz", motion.fastest_hz);
    motion.size_rad = map.NonNegativeOr("size_rad", motion.size_rad);
    motion.size_m = map.NonNegativeOr("size_m", motion.size_m);
    const double rows = motion.seconds * motion.rate_hz;
    if (rows < 2.0 || rows > kMostRows) {
      throw top_.Error("motion",
                       fmt::format("asks for {:g} rows, expected 2 to {:g}", rows, kMostRows));
    }
  }

  void ReadSensors() {
    if (!top_.Has("sensors")) {
      scenario_.sensors = {true, true, true, true, true};
      return;
    }
    ArmSensors& sensors = scenario_.sensors;
    sensors = {false, false, false, false, false};
    const std::map<std::string, bool*> named{{"joints_command0", &sensors.command},
                                             {"joints0", &sensors.encoders},
                                             {"joints_seen0", &sensors.seen},
                                             {"torque0", &sensors.torque},
                                             {"pose0", &sensors.pose}};
    for (const std::string& name : top_.Texts("sensors")) {
      const auto found = named.find(name);
      if (found == named.end()) {
        throw top_.Error("sensors", fmt::format("found {}, expected joints_command0, joints0, "
                                                "joints_seen0, torque0 or pose0",
                                                name));
      }
      *found->second = true;
    }
  }

  /// A number a joint.
  Eigen::VectorXd List(const YamlMap& map, const std::string& key) const {
    const auto values = map.Numbers(key, static_cast<std::size_t>(Joints()));
    return Eigen::Map<const Eigen::VectorXd>(values.data(), Joints());
  }
  Eigen::VectorXd ListOr0(const YamlMap& map, const std::string& key) const {
    return map.Has(key) ? List(map, key) : Eigen::VectorXd::Zero(Joints());
  }
  Eigen::VectorXd NonNegativeList(const YamlMap& map, const std::string& key) const {
    const Eigen::VectorXd list = ListOr0(map, key);
    if (list.size() > 0 && list.minCoeff() < 0.0)
      throw map.Error(key, fmt::format("found {}, expected 0 or more", list.minCoeff()));
    return list;
  }

  /// 1 over a compliance; 0 is as stiff as the plant's own `drive` says.
  Eigen::VectorXd StiffnessBy(const Eigen::VectorXd& compliance, double JointDrive::*drive) const {
    Eigen::VectorXd stiffness(Joints());
    for (int i = 0; i < Joints(); ++i) {
      const bool turns = scenario_.arm.joints[std::size_t(i)].type == JointType::kRevolute;
      stiffness[i] = StiffnessOf(compliance[i], StiffDrive(turns).*drive);
    }
    return stiffness;
  }

  void ReadEffects() {
    if (!top_.Has("effects")) return;
    const YamlMap effects = Section(top_, "effects");
    ArmFaults& faults = scenario_.faults;
    Eigen::VectorXd lag_s = Eigen::VectorXd::Zero(Joints()), droop = lag_s;
    for (const std::string& name : effects.Keys()) {
      const YamlMap map = Section(effects, name);
      if (name == "joint_offset") {
        faults.encoder_offset = List(map, "offset");
      } else if (name == "joint_scale") {
        faults.encoder_scale = List(map, "scale").array() - 1.0;
        if (faults.encoder_scale.minCoeff() <= -1.0) throw map.Error("scale", "expected above 0");
      } else if (name == "joint_coupling") {
        faults.routing = Coupling(map);
      } else if (name == "joint_backlash") {
        faults.play = NonNegativeList(map, "width");
      } else if (name == "joint_compliance") {
        faults.cable_stiffness =
            StiffnessBy(NonNegativeList(map, "compliance"), &JointDrive::cable_stiffness);
      } else if (name == "command_latency") {
        faults.command_delay_s = AtMost(map, "delay_s", kLongest_s);
      } else if (name == "servo_lag") {
        lag_s = NonNegativeList(map, "time_s");
      } else if (name == "servo_droop") {
        droop = NonNegativeList(map, "compliance");
        faults.servo_holds_gravity = false;
      } else if (name == "joint_friction") {
        faults.motor_coulomb = NonNegativeList(map, "coulomb");
        faults.motor_viscous = NonNegativeList(map, "viscous");
      } else if (name == "link_geometry") {
        faults.a_change_m = List(map, "a_m");
      } else if (name == "payload") {
        faults.payload.push_back(Payload(map));
      } else if (name == "tool_offset") {
        faults.marker_m = map.Vector3("offset_m");
      } else if (name == "tracker_registration") {
        faults.tracker_m = map.Vector3("translation_m");
      } else {
        throw effects.Error(name, "found '" + name + "', which is no effect of a simulated arm");
      }
    }
    if (lag_s.isZero(0.0) && droop.isZero(0.0)) return;
    faults.servo_stiffness = StiffnessBy(droop, &JointDrive::servo_stiffness);
    faults.servo_damping = faults.servo_stiffness.cwiseProduct(lag_s.cwiseMax(kUsualLag_s));
  }

  static double AtMost(const YamlMap& map, const std::string& key, double most) {
    const double value = map.NonNegative(key);
    if (value > most)
      throw map.Error(key, fmt::format("found {}, expected at most {}", value, most));
    return value;
  }

  /// The off-diagonal entries row by row: how far a motor's cable pulls each joint.
  Eigen::MatrixXd Coupling(const YamlMap& map) const {
    const int n = Joints();
    const auto values = map.Numbers("matrix", static_cast<std::size_t>(n * n - n));
    Eigen::MatrixXd routing = Eigen::MatrixXd::Identity(n, n);
    std::size_t next = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i != j) routing(i, j) = values[next++];
    return routing;
  }

  /// At a place that the arm's file names, or at one on a link (counted from 1).
  PointMass Payload(const YamlMap& map) const {
    const double mass_kg = map.Positive("mass_kg");
    if (map.Has("place")) {
      const std::string name = map.Text("place");
      for (const PayloadPlace& place : scenario_.arm.payload_places)
        if (place.name == name && place.keeps_orientation_of == 0)
          return {place.link - 1, mass_kg, place.p_m};
      throw map.Error("place",
                      "found '" + name + "', which the arm's file does not have on a link");
    }
    const auto link = map.Integer("link");
    if (link < 1 || link > Joints())
      throw map.Error("link", fmt::format("found {}, expected 1 to {}", link, Joints()));
    return {static_cast<int>(link) - 1, mass_kg,
            map.Has("p_m") ? map.Vector3("p_m") : Eigen::Vector3d(Eigen::Vector3d::Zero())};
  }

  std::filesystem::path file_;
  ReadLog& log_;
  YamlMap top_;
  std::vector<YamlMap> sections_;
  ArmScenario scenario_;
};

}  // namespace

bool IsArmScenario(const std::filesystem::path& file) { return YamlMap::Load(file).Has("arm"); }

ArmScenario ReadArmScenario(const std::filesystem::path& file, ReadLog& log) {
  return Reader(file, log).Read();
}

}  // namespace flextip::simulation
