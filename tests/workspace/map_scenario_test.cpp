// Scenario files of maps: what they say, and every way in which they can be wrong.
#include "workspace/map_scenario.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/error.h"

namespace flextip {
namespace {

using testing::HasSubstr;

class MapScenarioFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  AnyMapScenario Read(const std::string& text) const {
    std::ofstream(file_) << text;
    return ReadMapScenario(file_);
  }
  std::string Complaint(const std::string& text) const {
    try {
      Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() /
      (std::string("flextip_map_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
       ".yaml");
};

const std::string kPlane =
    "arm: {kind: planar}\ninstrument: {length_m: 0.3}\nport: {position_m: [0, 0.01, 0.16]}\n";
const std::string kSpace =
    "arm: {kind: three_joint}\ninstrument: {length_m: 0.3}\nport: {position_m: [0.1, 0, 0.16]}\n";

TEST_F(MapScenarioFile, InThePlaneIsReadAsZAndY) {
  const auto scenario = std::get<MapScenario<2>>(
      Read("arm: {kind: planar, links_m: [0.2, 0.25], joint1_rad: [-1, 0.5]}\n"
           "instrument: {length_m: 0.3}\nport: {position_m: [0, 0.01, 0.16]}\ngain: 0.5\n"
           "errors: {port_m: [0, 0.02, 0.03], links_m: [0.001, 0.002], joints_rad: [0.1, 0.2], "
           "shaft_m: 0.004}\n"
           "tip_force: {bending_stiffness_Nm2: 0.3, force_N: [0, -2, 1]}\n"
           "grid: {spacing_m: 0.01}\n"
           "tolerance: {shape: ellipsoid, bounds: {port_m: [0, 0.001, 0.002]}, angle_deg: 30, "
           "part: {min_m: [0, -0.1, 0.2], max_m: [0, 0.1, 0.4]}}\n"
           "plan: {start_m: [0, 0.1, 0.3], goal_m: [0, -0.1, 0.3], error: angle, weight: 3, "
           "move_m: 0.01}\n"));
  EXPECT_EQ(scenario.setup.truth.arm.link2_m, 0.25);
  EXPECT_EQ(scenario.setup.truth.arm.limits.joint1_max, 0.5);
  EXPECT_EQ(scenario.setup.truth.arm.limits.joint2_max, 1.0);  // the thesis's
  EXPECT_EQ(scenario.setup.truth.p_port, Eigen::Vector2d(0.16, 0.01));
  EXPECT_EQ(scenario.setup.error.port_m, Eigen::Vector2d(0.03, 0.02));
  EXPECT_EQ(scenario.setup.error.joints_rad, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(scenario.setup.force->force_N, Eigen::Vector2d(1.0, -2.0));
  EXPECT_EQ(scenario.setup.gain, 0.5);
  EXPECT_EQ(scenario.spacing_m, 0.01);
  ASSERT_EQ(scenario.slices.size(), 1U);
  EXPECT_EQ(scenario.tolerance->question.bounds.half_width.port_m, Eigen::Vector2d(0.002, 0.001));
  EXPECT_EQ(scenario.tolerance->question.bounds.shape, BoundShape::kEllipsoid);
  EXPECT_EQ(scenario.tolerance->question.measure, Measure::kAngle);
  EXPECT_NEAR(scenario.tolerance->question.limit, std::numbers::pi / 6.0, 1e-15);
  EXPECT_EQ(scenario.tolerance->question.part_min, Eigen::Vector2d(0.2, -0.1));
  EXPECT_EQ(scenario.plan->goal, Eigen::Vector2d(0.3, -0.1));
  EXPECT_EQ(scenario.plan->options.fault, MotionFault::kAngle);
  EXPECT_EQ(scenario.plan->follow.move_m, 0.01);
}

TEST_F(MapScenarioFile, InSpaceHasSlices) {
  const auto scenario = std::get<MapScenario<3>>(
      Read(kSpace + "grid: {slices: [{plane: zy, offset_m: 0.1}, {plane: xy, offset_m: 0.3}]}\n"));
  ASSERT_EQ(scenario.slices.size(), 2U);
  const Eigen::Vector3d first(0.1, 3.0, 2.0), second(2.0, 3.0, 0.3);
  EXPECT_EQ(scenario.slices[0].second.Point(2.0, 3.0), first);
  EXPECT_EQ(scenario.slices[1].second.Point(2.0, 3.0), second);
}

TEST_F(MapScenarioFile, OfTheProjectAreAllRead) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/maps")) {
    EXPECT_NO_THROW(ReadMapScenario(entry.path())) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 3);
}

TEST_F(MapScenarioFile, ThatIsWrongIsRefusedWithItsLine) {
  struct Wrong {
    std::string text, line, says;
  };
  const std::string bounds = "tolerance: {bounds: {port_m: [0, 0.001, 0]}, ";
  const Wrong cases[] = {
      {"arm: {kind: snake}\n", ":1: ", "found 'snake', expected one of planar, three_joint"},
      {"arm: {kind: planar}\n", ":1: ", "instrument"},
      {"seed: 1\ncontrollers: all\n", ":2: ", "a scenario of flextip simulate"},
      {kPlane + "gian: 1\n", ":4: ", "unknown key \"gian\""},
      {kPlane + "errors: {prot_m: [0, 0, 0]}\n", ":4: ", "unknown key \"errors.prot_m\""},
      {kPlane + "gain: 0\n", ":4: ", "gain"},
      {kPlane + "errors: {port_m: [0.1, 0, 0]}\n", ":4: ", "expected 0"},
      {kPlane + "errors: {joints_rad: [0.1, 0, 0]}\n", ":4: ", "joints_rad"},
      {kPlane + "errors: {links_m: [-1, 0]}\n", ":4: ", "without length"},
      {kPlane + "errors: {shaft_m: -0.3}\n", ":4: ", "without length"},
      {kPlane + "grid: {spacing_m: 0.00001}\n", ":4: ", "expected at least"},
      {kPlane + "grid: {slices: [{plane: zy}]}\n", ":4: ", "one plane"},
      {kSpace + "grid: {slices: [{plane: yz}]}\n", ":4: ", "expected one of zy, zx, xy"},
      {kSpace + "grid: {slices: []}\n", ":4: ", "slices"},
      {"arm: {kind: planar, joint1_rad: [1, -1]}\n", ":1: ", "smaller angle first"},
      {"arm: {kind: planar, links_m: [1, 0]}\n", ":1: ", "two positive lengths"},
      {kPlane + bounds + "}\n", ":4: ", "either norm or angle_deg"},
      {kPlane + bounds + "norm: 1, angle_deg: 3}\n", ":4: ", "either norm or angle_deg"},
      {kPlane + bounds + "norm: 1, shape: ball}\n", ":4: ", "expected one of box, ellipsoid"},
      {kPlane + "tolerance: {bounds: {port_m: [0, 0, 0]}, norm: 1}\n", ":4: ", "some of them"},
      {kPlane + "tolerance: {bounds: {shaft_m: -1}, norm: 1}\n", ":4: ", "not negative"},
      {kPlane + bounds + "norm: 1, part: {min_m: [0, 1, 0], max_m: [0, 0, 1]}}\n",
       ":4: ", "above max_m"},
      {kPlane + "plan: {start_m: [0, 0, 0.3]}\n", ":4: ", "goal_m"},
      {kPlane + "plan: {start_m: [0, 0, 0.3], goal_m: [0, 0, 0.4], error: none}\n",
       ":4: ", "expected one of norm, angle, stray"},
      {kSpace + "plan: {start_m: [0.1, 0, 0.3], goal_m: [0, 0, 0.4]}\n", ":4: ", "first slice"},
      {kPlane + "tip_force: {bending_stiffness_Nm2: 0, force_N: [0, 1, 0]}\n",
       ":4: ", "bending_stiffness_Nm2"},
      {kPlane + "errors: {shaft_m: .nan}\n", ":4: ", "shaft_m"},
  };
  for (const auto& wrong : cases) {
    const std::string complaint = Complaint(wrong.text);
    EXPECT_THAT(complaint, HasSubstr(file_.string() + wrong.line)) << wrong.text;
    EXPECT_THAT(complaint, HasSubstr(wrong.says)) << wrong.text;
    EXPECT_EQ(complaint.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace flextip
