// Scenarios, sessions, models (of shafts and of arms), maps and meshes.
#include "arms/diagnose/model_file.h"
#include "diagnosis/model/extended_model.h"
#include "live/session/session.h"
#include "simulation/closed_loop/scenario.h"
#include "task/mesh_file.h"
#include "task/path_time.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"
#include "workspace/map_scenario.h"

namespace flextip {

int CheckScenarioInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("scenario.yaml", TextOf(input));
  const bool read = ReadsOrRefuses([&] {
    const simulation::Scenario scenario = simulation::ReadScenario(file);
    const simulation::LoopSetup& loop = scenario.loop;
    Require(loop.update_rate_hz >= 1e-4 && loop.update_rate_hz <= 1e5);
    Require(loop.path.mode == PathMode::kSteps || PathSeconds(loop.path, 1e3) <= kLongestPath_s);
    Require(loop.p_RW_start.allFinite());
  });
  return read ? 1 : 0;
}

int CheckSessionInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("session.yaml", TextOf(input));
  return ReadsOrRefuses([&] { live::ReadSession(file); }) ? 1 : 0;
}

int CheckModelInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("model.yaml", TextOf(input));
  diagnosis::ExtendedModel model;
  if (!ReadsOrRefuses([&] { model = diagnosis::ReadModel(file); })) return 0;
  const std::string text = diagnosis::ModelYaml(model);
  Require(diagnosis::ModelYaml(diagnosis::ReadModel(folder.Write("again.yaml", text))) == text);
  return 1;
}

int CheckArmModelInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("model.yaml", TextOf(input));
  arms::ArmModel model;
  if (!ReadsOrRefuses([&] { model = arms::ReadArmModel(file); })) return 0;
  const std::string text = arms::ArmModelYaml(model);
  Require(arms::ArmModelYaml(arms::ReadArmModel(folder.Write("again.yaml", text))) == text);
  return 1;
}

int CheckMapInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("map.yaml", TextOf(input));
  const bool read = ReadsOrRefuses([&] {
    std::visit(
        [](const auto& map) {
          Require(!map.slices.empty());
          Require(map.spacing_m * 400.0 >= map.setup.truth.shaft_m * (1.0 - 1e-9));
        },
        ReadMapScenario(file));
  });
  return read ? 1 : 0;
}

int CheckMeshInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("mesh.obj", TextOf(input));
  TriangleMesh mesh;
  if (!ReadsOrRefuses([&] { mesh = ReadMesh(file); })) return 0;
  for (const auto& point : mesh.points) Require(point.allFinite());
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) Require(corner >= 0 && corner < int(mesh.points.size()));
  }
  return mesh.triangles.empty() ? 0 : 1;
}

}  // namespace flextip
