#include <fmt/format.h>

#include <algorithm>

#include "recording/streams/sensor_streams.h"
#include "simulation/closed_loop/scenario_sections.h"
#include "task/task_reader.h"

namespace flextip::simulation {
namespace {

EmStream ReadEm(const YamlMap& map, double length_m, bool on_port) {
  EmStream em;
  em.comment = on_port ? "EM sensor on the port" : "EM sensor on the shaft";
  em.rate_hz = map.Positive("rate_hz");
  em.orientation_noise_rad = map.NonNegative("orientation_noise_rad");
  em.position_noise_m =
      on_port ? map.NonNegativeOr("position_noise_m", 0.0) : map.NonNegative("position_noise_m");
  if (!on_port) {
    em.distance_from_tip_m = map.NonNegative("distance_from_tip_m");
    if (em.distance_from_tip_m > length_m) {
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

void ReadStrain(const YamlMap& map, double length_m, StrainStream& strain) {
  strain.comment = "strain gages";
  strain.rate_hz = map.Positive("rate_hz");
  strain.moment_noise_Nm = map.NonNegative("moment_noise_Nm");
  const auto stations = map.Numbers("stations_from_wrist_m", 2);
  if (!(0 <= stations[0] && stations[0] < stations[1] && stations[1] <= length_m)) {
    throw map.Error("stations_from_wrist_m",
                    fmt::format("found {} and {}, expected two places along the shaft of {} m",
                                stations[0], stations[1], length_m));
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

}  // namespace

SensorSetup ReadScenarioSensors(const YamlMap& map, double length_m,
                                std::vector<YamlMap>& sections) {
  SensorSetup sensors;
  const auto section = [&](const std::string& key) {
    sections.push_back(map.Map(key));
    return sections.back();
  };
  const YamlMap wrist = section("wrist");
  sensors.wrist.emplace();
  sensors.wrist->comment = "wrist encoders";
  sensors.wrist->rate_hz = wrist.Positive("rate_hz");
  sensors.wrist->position_noise_m = wrist.NonNegative("position_noise_m");
  sensors.wrist->orientation_noise_rad = wrist.NonNegative("orientation_noise_rad");
  if (map.Has("em0")) sensors.em0 = ReadEm(section("em0"), length_m, false);
  if (map.Has("em1")) sensors.em1 = ReadEm(section("em1"), length_m, true);
  if (map.Has("strain")) ReadStrain(section("strain"), length_m, sensors.strain.emplace());
  if (map.Has("load")) {
    const YamlMap load = section("load");
    sensors.load.emplace();
    sensors.load->comment = "load cell on the tip";
    sensors.load->rate_hz = load.Positive("rate_hz");
    sensors.load->force_noise_N = load.NonNegative("force_noise_N");
  }
  if (map.Has("tip")) ReadTip(section("tip"), sensors.tip.emplace());
  return sensors;
}

}  // namespace flextip::simulation
