#include <fmt/format.h>

#include "recording/cameras/camera_file.h"
#include "recording/streams/sensor_streams.h"
#include "simulation/closed_loop/scenario_sections.h"
#include "task/task_reader.h"

namespace flextip::simulation {
namespace {

Occluder ReadOccluder(const YamlMap& map) {
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
  return occluder;
}

}  // namespace

void ReadScenarioCamera(const YamlMap& map, const std::filesystem::path& folder,
                        std::vector<YamlMap>& sections, Scenario& scenario) {
  LoopSetup& loop = scenario.loop;
  ReadLog log;
  loop.base.cam0.emplace();
  loop.base.cam0->comment = "rendered laparoscope";
  loop.base.cam0->calibration = ReadCameraCalibration(folder / map.Text("calibration"), &log);
  loop.base.tags0 = ReadTags(folder / map.Text("collar"), log);
  scenario.warnings.insert(scenario.warnings.end(), log.warnings.begin(), log.warnings.end());
  if (map.Has("rate_hz")) loop.base.cam0->calibration.rate_hz = map.Positive("rate_hz");
  loop.update_rate_hz = loop.base.cam0->calibration.rate_hz;
  if (loop.sensors.tip) {
    loop.sensors.tip->rate_hz = loop.update_rate_hz;
    loop.sensors.tip->T_RC = loop.base.cam0->calibration.T_RC;
  }
  scenario.has_camera = true;

  LaparoscopeOptions& scope = scenario.laparoscope;
  scope.exposure = map.PositiveOr("exposure", scope.exposure);
  scope.blur_sigma_px = map.NonNegativeOr("blur_sigma_px", scope.blur_sigma_px);
  scope.full_well_electrons = map.NonNegativeOr("full_well_electrons", scope.full_well_electrons);
  scope.read_noise_electrons =
      map.NonNegativeOr("read_noise_electrons", scope.read_noise_electrons);
  scope.tissue.relief_m = map.NonNegativeOr("tissue_relief_m", scope.tissue.relief_m);
  if (map.Has("tissue_point_m")) scope.tissue.point_R = map.Vector3("tissue_point_m");
  if (map.Has("tissue_normal")) scope.tissue.normal_R = ReadUnit(map, "tissue_normal");
  if (map.Has("occluders")) {
    for (const YamlMap& occluder : map.Maps("occluders")) {
      sections.push_back(occluder);
      scope.occluders.push_back(ReadOccluder(occluder));
    }
  }
  scenario.tracker.detector.quad_decimate = map.PositiveOr("quad_decimate", 1.0);
}

}  // namespace flextip::simulation
