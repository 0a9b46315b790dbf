#include <gtest/gtest.h>

#include "live/udp/listener.h"

namespace flextip::live {
namespace {

std::vector<WireMessage> Poses(const std::string& text, bool good = true) {
  std::string problem;
  auto poses = PosesInJson(text, problem);
  EXPECT_EQ(problem.empty(), good) << problem;
  return poses;
}

TEST(PosesInJson, MetresRowsAndSeconds) {
  const auto poses = Poses(
      R"({"measured_cp": {"AutomaticTimestamp": false,
         "Position": {"Rotation": [0,-1,0,1,0,0,0,0,1],
                      "Translation": [0.1, -0.2, 0.3]}, "Timestamp": 1700000000.25, "Valid": true},
         "measured_js": {"Position": [1, 2]}})");
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].device, "measured_cp");
  EXPECT_EQ(poses[0].t_ns, 1'700'000'000'250'000'000);
  const auto& T = std::get<WireTransform>(poses[0].body).T_RD;
  EXPECT_EQ(T.p, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(T.R * Eigen::Vector3d::UnitX(), Eigen::Vector3d(0, 1, 0));
}

TEST(PosesInJson, RowsAsListsAndInvalidData) {
  const auto poses = Poses(
      R"({"a": {"Position": {"Rotation": [[1,0,0],[0,1,0],[0,0,1]], "Translation": [0,0,0]},
         "Timestamp": 5, "Valid": false}})");
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].t_ns, 0);
}

TEST(PosesInJson, RefusesAllElse) {
  for (const char* text :
       {"", "[]", "{}", "{", R"({"a": {"Position": {"Rotation": [1], "Translation": [0,0,0]}}})",
        R"({"a": {"Position": {"Rotation": [1,0,0,0,1,0,0,0,1], "Translation": [0,0,"x"]}}})",
        R"({"a": {"Position": {"Rotation": [1,0,0,0,1,0,0,0,1], "Translation": [0,0,1e999]}}})"}) {
    EXPECT_TRUE(Poses(text, false).empty()) << text;
  }
  EXPECT_TRUE(Poses(std::string(100000, '['), false).empty());
}

}  // namespace
}  // namespace flextip::live
