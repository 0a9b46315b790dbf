// Every tag family through the whole of vision on rendered frames: the collar's pose, and that of a
// single flat tag.
#include <gtest/gtest.h>

#include "core/rotation.h"
#include "tests/simulation/render_test_scene.h"
#include "vision/tags/collar_pose.h"

namespace flextip::simulation {
namespace {

using namespace render_test;

struct Family {
  const char* name;
  double collar_size_m;  ///< so that the cells outside the corners fit on a side of 5.8 mm too
  int id;                ///< of the flat tag
};
const Family kFamilies[] = {{"tag36h11", 0.0045, 5},         {"tag25h9", 0.0043, 3},
                            {"tag16h5", 0.0041, 2},          {"tagStandard41h12", 0.0031, 9},
                            {"tagStandard52h13", 0.0033, 7}, {"tagCircle21h7", 0.0031, 11}};

CameraCalibration Camera() {
  CameraCalibration camera = SmallCamera();
  camera.fu_px = camera.fv_px = 420;
  camera.distortion_coefficients = {-0.1, 0.02, 0.0006, -0.0004};
  return camera;
}

LaparoscopeOptions Options() {
  LaparoscopeOptions o = PlainOptions();
  o.blur_sigma_px = 0.7;
  o.full_well_electrons = 15000;
  o.exposure = 0.2;
  o.exposure_distance_m = 0.06;
  return o;
}

TagCollar Collar(const Family& family) {
  TagCollar collar = HexagonCollar();
  collar.family = family.name;
  for (CollarTag& tag : collar.tags) tag.size_m = family.collar_size_m;
  return collar;
}

// Beside the shaft's end, tilted: a single target as glued onto an instrument.
TagCollar FlatTag(const Family& family) {
  TagCollar collar;
  collar.family = family.name;
  CollarTag tag{family.id, 0.009, {}};
  tag.T_EG.R = ExpRotation({0.3, -0.25, 0.4});
  tag.T_EG.p = {0.012, 0.001, -0.004};
  collar.tags.push_back(tag);
  return collar;
}

struct Seen {
  CollarPose pose;
  double tag_error_m = 0.0, angle_rad = 0.0;  // of the tags' place, and of the direction
};

Seen See(const TagCollar& collar, const Pose& T_CE, int number) {
  const CameraCalibration camera = Camera();
  const Laparoscope scope(camera, collar, Options());
  const Image image = scope.Render(ArcShaft(T_CE, 0.1, 0.9, 0.005), number);
  TagDetectorOptions options;
  options.family = collar.family;
  options.refine_edges = true;
  const auto tags = TagDetector(options).Detect(image);
  Seen seen;
  seen.pose = EstimateCollarPose(CameraModel(camera), collar, tags, {}, T_CE);
  Eigen::Vector3d centre_E = Eigen::Vector3d::Zero();
  for (const CollarTag& tag : collar.tags) {
    centre_E += tag.T_EG.p / static_cast<double>(collar.tags.size());
  }
  seen.tag_error_m = (seen.pose.T_CE * centre_E - T_CE * centre_E).norm();
  seen.angle_rad = LogRotation(seen.pose.T_CE.R * T_CE.R.transpose()).norm();
  return seen;
}

class RenderFamilies : public testing::TestWithParam<Family> {};

// Corners read in another order, at another border or with the colours swapped would be a cell or
// a quarter turn off: millimetres and radians.
TEST_P(RenderFamilies, TheCollarsPoseIsRight) {
  Pose T_CE;
  T_CE.R = ExpRotation({0.05, 0.3, -0.2}) * ExpRotation({-1.2, 0, 0});
  T_CE.p = {0.03, 0.002, 0.055};
  const Seen seen = See(Collar(GetParam()), T_CE, 3);
  ASSERT_TRUE(seen.pose.IsUsable());
  EXPECT_GE(seen.pose.tags_used, 2);
  EXPECT_LT(seen.tag_error_m, 1e-4);
  EXPECT_LT(seen.angle_rad, 0.005);
  EXPECT_LT(seen.pose.rms_px, 0.06);
}

TEST_P(RenderFamilies, ASingleFlatTagsPoseIsRight) {
  Pose T_CE;
  T_CE.R = ExpRotation({0, 0.1, 0.2});
  T_CE.p = {-0.01, -0.001, 0.06};
  const Seen seen = See(FlatTag(GetParam()), T_CE, 1);
  ASSERT_TRUE(seen.pose.IsUsable());
  EXPECT_EQ(seen.pose.tags_used, 1);
  EXPECT_LT(seen.tag_error_m, 1e-4);
  EXPECT_LT(seen.angle_rad, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Families, RenderFamilies, testing::ValuesIn(kFamilies),
                         [](const auto& family) { return std::string(family.param.name); });

}  // namespace
}  // namespace flextip::simulation
