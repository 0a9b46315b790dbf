#include "simulation/closed_loop/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "control/tip_path.h"
#include "core/error.h"
#include "task/mesh_file.h"

namespace flextip::simulation {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kPress = fs::path(FLEXTIP_SOURCE_DIR) / "testdata/scenarios/press.yaml";

std::string PressText() {
  std::ifstream file(kPress);
  std::stringstream text;
  text << file.rdbuf();
  std::string s = text.str();
  // The camera's files are named relative to the scenario: absolute here, for a copy elsewhere.
  const std::string up = "../", data = kPress.parent_path().parent_path().string() + "/";
  for (std::size_t at; (at = s.find(up)) != std::string::npos;) s.replace(at, up.size(), data);
  return s;
}

/// Returns the message of reading the scenario with `from` replaced by `to`, empty for none. A
/// message about the scenario itself names its file; with `other_file` that of another.
std::string Complaint(const std::string& from, const std::string& to,
                      const std::string& other_file = "") {
  std::string text = PressText();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const fs::path file =
      fs::path(testing::TempDir()) / ("scenario_test_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << text;
  try {
    ReadScenario(file);
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(other_file.empty() ? file.string() : other_file));
    EXPECT_THAT(e.what(), testing::Not(HasSubstr("\n")));
    return e.what();
  }
  return "";
}

TEST(Scenario, SaysWhatTheControllerIsToldOfTimes) {
  std::string text = PressText();
  const std::string control = "control: {";
  text.replace(text.find(control), control.size(),
               control +
                   "rate_hz: 120, tip_latency_s: {value: 0.062, sd: 0.004}, "
                   "em0_latency_s: {value: 0.02}, ");
  const fs::path file =
      fs::path(testing::TempDir()) / ("scenario_times_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << text;
  const LoopSetup loop = ReadScenario(file).loop;
  EXPECT_EQ(loop.update_rate_hz, 120.0);
  EXPECT_EQ(loop.sensors.tip->rate_hz, 30.0);
  EXPECT_EQ(loop.tip_latency.value_s, 0.062);
  EXPECT_EQ(loop.tip_latency.sd_s, 0.004);
  EXPECT_EQ(loop.em0_latency.value_s, 0.02);
  EXPECT_THAT(Complaint(control, control + "tip_latency_s: {sd: 0.1}, "), HasSubstr("value"));
}

TEST(Scenario, PressReads) {
  const Scenario scenario = ReadScenario(kPress);
  EXPECT_EQ(scenario.controllers.size(), 6u);
  EXPECT_TRUE(scenario.has_camera);
  EXPECT_DOUBLE_EQ(scenario.loop.plant.load.tissue->stiffness_N_m, 50.0);
  EXPECT_EQ(scenario.loop.path.waypoints_m.size(), 3u);
  EXPECT_DOUBLE_EQ(scenario.loop.update_rate_hz, 30.0);
}

TEST(Scenario, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: -0.6"), HasSubstr("length_m"));
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: long"), HasSubstr(":3:"));
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: .nan"), HasSubstr("length_m"));
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: 0.2"), HasSubstr("out of reach"));
  EXPECT_THAT(Complaint("stiffness_N_m: 50", "stifness_N_m: 50"), HasSubstr("stiffness_N_m"));
  EXPECT_THAT(Complaint("settle_s: 0.3", "setle_s: 0.3"), HasSubstr("unknown key"));
  EXPECT_THAT(Complaint("controllers: all", "controllers: bent"), HasSubstr("'bent'"));
  EXPECT_THAT(Complaint("controllers: all", "controllers: [rod-track, bent]"), HasSubstr("'bent'"));
  EXPECT_THAT(Complaint("normal: [0.0, 0.0, 1.0]", "normal: [0, 0, 0]"), HasSubstr("zero vector"));
  EXPECT_THAT(Complaint("[0.15, 0.5]", "[0.15, 0.9]"), HasSubstr("stations_from_wrist_m"));
  EXPECT_THAT(Complaint("beam_load_law: tip_force", "beam_load_law: none"), HasSubstr("'none'"));
  EXPECT_EQ(Complaint("controllers: all", "controllers: [rod-track, flex-track]"), "");
}

TEST(Scenario, ADoubtIsAProbability) {
  const std::string control = "control: {";
  EXPECT_EQ(Complaint(control, "supervisor: {doubt: 0.01, doubt_s: 0.3}\n" + control), "");
  EXPECT_THAT(Complaint(control, "supervisor: {doubt: 0.5}\n" + control), HasSubstr("at most 0.1"));
}

TEST(Scenario, TheRunningDiagnosisReads) {
  EXPECT_FALSE(ReadScenario(kPress).loop.watch);
  std::string text = PressText();
  const std::string control = "control: {", on = "diagnosis: {running: true}\n";
  text.insert(text.find(control), on);
  const fs::path file =
      fs::path(testing::TempDir()) / ("watched_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << text;
  const LoopSetup loop = ReadScenario(file).loop;
  ASSERT_TRUE(loop.watch);
  EXPECT_FALSE(loop.watch()->Found().IsThere());
  EXPECT_THAT(Complaint(control, "diagnosis: {running: perhaps}\n" + control),
              HasSubstr("running"));
  EXPECT_THAT(Complaint(control, "diagnosis: {false_alarms_per_hour: 1000}\n" + control),
              HasSubstr("expected at most 100"));
  EXPECT_THAT(Complaint(control, "diagnosis: {runs: true}\n" + control), HasSubstr("runs"));
}

TEST(Scenario, FixturesAndDirectionsRead) {
  const fs::path folder = kPress.parent_path();
  const Scenario fixtures = ReadScenario(folder / "fixtures.yaml");
  ASSERT_EQ(fixtures.loop.fixtures.list.size(), 3u);
  EXPECT_DOUBLE_EQ(fixtures.loop.fixtures.margin_sd, 2.0);
  EXPECT_EQ(std::get<ForbiddenMesh>(fixtures.loop.fixtures.list[1]).TriangleCount(), 12);
  EXPECT_TRUE(std::get<ForbiddenSphere>(fixtures.loop.fixtures.list[2]).forbidden_outside);
  const Scenario direction = ReadScenario(folder / "direction.yaml");
  ASSERT_TRUE(direction.loop.direction);
  EXPECT_EQ(direction.loop.direction->priority, DirectionPriority::kPositionFirst);
  EXPECT_EQ(direction.loop.direction_free_axis, Eigen::Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(direction.loop.direction->max_step_m, 0.02);
  EXPECT_NEAR(direction.loop.path.directions.at(0).norm(), 1.0, 1e-12);
}

/// The press with `fixture` as its only one.
std::string FixtureComplaint(const std::string& fixture, const std::string& other_file = "") {
  return Complaint("controllers: all", "fixtures:\n  - " + fixture + "\ncontrollers: all",
                   other_file);
}

TEST(Scenario, SaysWhatIsWrongWithFixtures) {
  EXPECT_EQ(FixtureComplaint("guidance: {points: [{at_m: [0, 0, 0]}, {at_m: [1, 0, 0]}]}"), "");
  EXPECT_EQ(FixtureComplaint("sphere: {centre_m: [0, 0, 0], radius_m: 1}"), "");
  EXPECT_THAT(FixtureComplaint("cube: {edge_m: 1}"), HasSubstr("found cube"));
  EXPECT_THAT(FixtureComplaint("sphere: {centre_m: [0, 0, 0], radius_m: 0}"),
              HasSubstr("radius_m"));
  EXPECT_THAT(FixtureComplaint("sphere: {centre_m: [0, 0, 0], radius_m: 1, forbidden: all}"),
              HasSubstr("'all'"));
  EXPECT_THAT(FixtureComplaint("half_space: {point_m: [0, 0, 0], normal: [0, 0, 0]}"),
              HasSubstr("zero vector"));
  EXPECT_THAT(FixtureComplaint("half_space: {point_m: [0, 0, 0], norml: [0, 0, 1]}"),
              HasSubstr("norm"));
  EXPECT_THAT(FixtureComplaint("mesh: {file: none.obj}", "none.obj"), HasSubstr("no such file"));
  EXPECT_THAT(FixtureComplaint("guidance: {points: [{at_m: [0, 0, 0]}]}"), HasSubstr("two points"));
}

TEST(Scenario, SaysWhatIsWrongWithDirections) {
  const std::string first = "{to_m: [0.0, 0.0, -0.010]}";
  EXPECT_THAT(Complaint(first, "{to_m: [0, 0, -0.01], direction: [1, 0, 0]}"),
              HasSubstr("1 of 3 waypoints"));
  EXPECT_THAT(Complaint("max_step_m: 0.02", "direction: {priority: weighted}"),
              HasSubstr("needs a direction"));
  EXPECT_THAT(Complaint("    - " + first +
                            "\n    - {to_m: [0.0, 0.006, -0.010]}\n    - {to_m: [0.0, 0.006, 0.0]}",
                        "    - {to_m: [0, 0, -0.01], direction: [1, 0, 0]}"),
              HasSubstr("straight-calculate"));
}

/// What reading says of a mesh file.
std::string MeshComplaint(const std::string& text) {
  const fs::path file =
      fs::path(testing::TempDir()) / ("mesh_test_" + std::to_string(::getpid()) + ".obj");
  std::ofstream(file) << text;
  try {
    ReadMesh(file);
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(file.string()));
    return e.what();
  }
  return "";
}

TEST(MeshFile, CutsPolygonsAndSkipsWhatItDoesNotNeed) {
  const TriangleMesh box = ReadMesh(kPress.parent_path() / "box.obj");
  EXPECT_EQ(box.points.size(), 8u);
  EXPECT_EQ(box.triangles.size(), 12u);
  EXPECT_EQ(MeshComplaint("o box\nv 0 0 0\nv 1 0 0\nvn 0 0 1\nv 0 1 0\nf 1//1 2/3/1 -1\n"), "");
}

TEST(MeshFile, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(MeshComplaint("v 0 0\n"), HasSubstr(":1:"));
  EXPECT_THAT(MeshComplaint("v 0 0 0\nf 1 1\n"), HasSubstr(":2:"));
  EXPECT_THAT(MeshComplaint("v 0 0 0\nf 1 2 1\n"), HasSubstr("'2'"));
  EXPECT_THAT(MeshComplaint("v 0 0 0\nf 0 1 1\n"), HasSubstr("'0'"));
  EXPECT_THAT(MeshComplaint("v 0 0 0\nf 1 x 1\n"), HasSubstr("'x'"));
}

/// The press with a section of effects.
std::string EffectComplaint(const std::string& effects) {
  return Complaint("controllers: all", "effects:\n" + effects + "controllers: all");
}

TEST(Scenario, EffectsAreGivenByNameAndParameter) {
  std::string text = PressText();
  text +=
      "effects:\n"
      "  stiffness: {scale: 0.8}\n"
      "  port_moment: {stiffness_Nm_rad: 0.2, rest_axis: [0, 0.6, 0.8]}\n"
      "  self_weight: {mass_per_length_kg_m: 0.03}\n"
      "  em_distortion: {gradient: [1, 2, 3, 4, 5, 6, 7, 8, 9], centre_m: [0.1, 0.2, 0.3]}\n"
      "  hand_eye: {rotation_rad: [0.01, 0, 0]}\n";
  const fs::path file = fs::path(testing::TempDir()) /
                        ("scenario_effects_test_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << text;
  const LoopSetup loop = ReadScenario(file).loop;
  EXPECT_DOUBLE_EQ(loop.plant.effects.stiffness_scale, 0.8);
  EXPECT_DOUBLE_EQ(loop.plant.effects.port_stiffness_Nm_rad, 0.2);
  EXPECT_EQ(loop.plant.effects.port_rest_axis, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_DOUBLE_EQ(loop.plant.effects.mass_per_length_kg_m, 0.03);  // the nominal one has none
  EXPECT_EQ(loop.sensor_effects.em_gradient(0, 1), 2.0);
  EXPECT_EQ(loop.sensor_effects.em_centre_m, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(loop.sensor_effects.hand_eye_rotation_rad.x(), 0.01);
  EXPECT_EQ(loop.sensor_effects.hand_eye_translation_m.norm(), 0.0);
  // What is not named is neutral.
  EXPECT_EQ(loop.plant.effects.length_delta_m, 0.0);
  EXPECT_EQ(loop.plant.effects.backlash_m, 0.0);
  EXPECT_EQ(loop.sensor_effects.focal_scale, 1.0);
}

TEST(Scenario, SaysWhatIsWrongWithItsEffects) {
  EXPECT_EQ(EffectComplaint("  stiffness: {scale: 0.8}\n"), "");
  EXPECT_THAT(EffectComplaint("  rust: {depth_m: 1}\n"), HasSubstr("'rust'"));
  EXPECT_THAT(EffectComplaint("  stiffness: {factor: 1}\n"), HasSubstr("'factor'"));
  EXPECT_THAT(EffectComplaint("  port_offset: {offset_m: [1, 2]}\n"), HasSubstr("2 numbers"));
  EXPECT_THAT(EffectComplaint("  port_offset: {offset_m: a}\n"), HasSubstr("offset_m"));
  EXPECT_THAT(EffectComplaint("  stiffness: {scale: -1}\n"), HasSubstr("not positive"));
  EXPECT_THAT(EffectComplaint("  backlash: {width_m: -0.1}\n"), HasSubstr("negative"));
  EXPECT_THAT(EffectComplaint("  backlash: {width_m: .nan}\n"), HasSubstr("width_m"));
}

TEST(Scenario, NamesAFileOfTheCameraThatIsMissing) {
  const fs::path file = fs::path(testing::TempDir()) /
                        ("scenario_camera_test_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << std::ifstream(kPress).rdbuf();  // its ../cameras is not there
  try {
    ReadScenario(file);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("laparoscope.yaml"));
  }
}

TEST(TipPath, ContinuousFollowsItsLegsAtItsSpeed) {
  PathSetup setup;
  setup.waypoints_m = {{0.01, 0, 0}, {0.01, 0.02, 0}};
  setup.speed_m_s = 0.03;
  setup.settle_s = 0.1;
  TipPath path(setup, {Eigen::Matrix3d::Identity(), {1, 2, 3}}, 30.0);
  Eigen::Vector3d last(1, 2, 3);
  double length = 0.0;
  int updates = 0;
  while (!path.Done()) {
    const Eigen::Vector3d p = path.Advance({0, 0, 0});
    EXPECT_LE((p - last).norm(), 0.001 + 1e-12);
    EXPECT_LT(path.Deviation(p), 1e-12);
    length += (p - last).norm();
    last = p;
    ASSERT_LE(++updates, path.MaxUpdates());
  }
  EXPECT_NEAR(length, 0.03, 1e-9);
  EXPECT_LT((last - Eigen::Vector3d(1.01, 2.02, 3)).norm(), 1e-12);
  EXPECT_NEAR(path.Deviation(Eigen::Vector3d(1.013, 2.01, 3)), 0.003, 1e-12);
}

TEST(TipPath, PlacesInRobotFrameAreGoneToFromWhereverTheTipIs) {
  PathSetup setup;
  setup.frame = PathFrame::kRobot;
  setup.waypoints_m = {{1.01, 2, 3}, {1.01, 2.02, 3}};
  setup.speed_m_s = 0.03;
  TipPath path(setup, {Eigen::Matrix3d::Identity(), {1, 2, 3}}, 30.0);
  EXPECT_LT((path.Advance({0, 0, 0}) - Eigen::Vector3d(1.001, 2, 3)).norm(), 1e-12);
  Eigen::Vector3d last(0, 0, 0);
  while (!path.Done()) last = path.Advance({0, 0, 0});
  EXPECT_LT((last - Eigen::Vector3d(1.01, 2.02, 3)).norm(), 1e-12);
}

TEST(Scenario, ReadsAPathFromAFile) {
  const fs::path motion =
      fs::path(testing::TempDir()) / ("scenario_motion_" + std::to_string(::getpid()) + ".yaml");
  const auto write = [&](const std::string& speed) {
    std::ofstream(motion) << "frame: R\n" << speed << "waypoints:\n  - {to_m: [0.24, 0, -0.01]}\n";
  };
  std::string text = PressText();
  const std::size_t from = text.find("path:"), to = text.find("controllers:");
  ASSERT_LT(from, to);
  text.replace(from, to - from, "path: {file: " + motion.string() + "}\n");
  const fs::path file =
      fs::path(testing::TempDir()) / ("scenario_path_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << text;
  write("speed_m_s: 0.02\n");
  const PathSetup path = ReadScenario(file).loop.path;
  EXPECT_EQ(path.frame, PathFrame::kRobot);
  EXPECT_EQ(path.speed_m_s, 0.02);
  ASSERT_EQ(path.waypoints_m.size(), 1u);
  EXPECT_EQ(path.waypoints_m[0], Eigen::Vector3d(0.24, 0, -0.01));
  write("spee_m_s: 0.02\n");
  try {
    ReadScenario(file);
    ADD_FAILURE() << "read a key that is unknown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(motion.string() + ":2: unknown key"));
  }
}

TEST(TipPath, DirectionsTurnEvenlyAlongALeg) {
  PathSetup setup;
  setup.waypoints_m = {{0.02, 0, 0}, {0.02, 0.02, 0}};
  setup.directions = {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY()};
  setup.speed_m_s = 0.02;
  TipPath path(setup, Pose(), 10.0);
  for (int i = 1; i <= 10; ++i) {
    path.Advance(Eigen::Vector3d::Zero());
    const Eigen::Vector3d d = *path.Direction();
    EXPECT_NEAR(std::atan2(d.y(), d.x()), i < 10 ? 0.1 * i * M_PI_2 : M_PI_2, 1e-9) << i;
  }
  setup.directions.clear();
  EXPECT_FALSE(TipPath(setup, Pose(), 10.0).Direction());
}

TEST(TipPath, StepsWaitAtTheEndUntilTheTipIsThere) {
  PathSetup setup;
  setup.mode = PathMode::kSteps;
  setup.waypoints_m = {{0.01, 0, 0}};
  TipPath path(setup, Pose(), 30.0);
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(path.Advance({0, 0, 0}).x(), 0.002 * i, 1e-15);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(path.Advance({0.009, 0, 0}).x(), 0.01);
  EXPECT_FALSE(path.Done());
  path.Advance({0.00999, 0, 0});
  EXPECT_TRUE(path.Done());
}

}  // namespace
}  // namespace flextip::simulation
