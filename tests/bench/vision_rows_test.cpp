#include "bench/vision/rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "bench/vision/scene.h"
#include "core/error.h"
#include "core/rotation.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

const CameraCalibration kCamera = BenchCamera(1280, 2.2);
const TagCollar kCollar = RingCollar("tag36h11", 0.005, 6, 1.0, 0.03);
const Pose kPose = CollarSeen({0.01, -0.005, 0.11}, 0.3, 0.2, 0.1, 0.03);

PictureTruth Truth() {
  PictureTruth truth{{}, kPose};
  for (const auto& tag : TagsInView(CameraModel(kCamera), kCollar, kPose, 1.2)) {
    truth.corners_px.insert(tag);
  }
  return truth;
}

PeerAnswer Moved(const PictureTruth& truth, const Eigen::Vector2d& by_px, const Pose& T_CE) {
  PeerAnswer answer{truth.corners_px, T_CE, 0};
  for (auto& [id, corners] : answer.corners_px) {
    for (Eigen::Vector2d& c : corners) c += by_px;
  }
  return answer;
}

// Errors put in by hand come out as the figures they are.
TEST(PeerScore, FiguresAreThoseOfKnownErrors) {
  const PictureTruth truth = Truth();
  ASSERT_GE(truth.corners_px.size(), 2u);
  PeerScore score(kCamera, kCollar);
  const Pose deeper{kPose.R, kPose.p + Eigen::Vector3d(0, 0, 0.001)};
  const Pose aside{ExpRotation({0, 0, 0.01}) * kPose.R, kPose.p + Eigen::Vector3d(0.002, 0, 0)};
  score.Add(Moved(truth, {0.3, 0.4}, deeper), truth);
  score.Add(Moved(truth, {0, 0}, aside), truth);
  score.Add({{}, Pose{kPose.R, kPose.p + Eigen::Vector3d(0.006, 0, 0)}, 4}, truth);  // false
  PeerAnswer far_off = Moved(truth, {5, 0}, kPose);  // another tag's place
  far_off.T_CE.reset();
  score.Add(far_off, truth);
  const PeerFigures f = score.Figures("peer");
  const int tags = static_cast<int>(truth.corners_px.size());
  EXPECT_EQ(f.pictures, 4);
  EXPECT_EQ(f.tags, 4 * tags);
  EXPECT_EQ(f.tags_found, 2 * tags);
  EXPECT_EQ(f.false_tags, tags);
  EXPECT_DOUBLE_EQ(f.Recall(), 0.5);
  EXPECT_EQ(f.poses, 3);
  EXPECT_EQ(f.false_poses, 1);
  EXPECT_NEAR(f.corner_rms_px, 0.5 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(f.tip_rms_mm, std::sqrt((1.0 + 4.0) / 2), 1e-9);
  EXPECT_NEAR(f.depth_bias_mm, 0.5, 1e-9);
  EXPECT_NEAR(f.turn_rms_deg, 0.01 * 180 / M_PI / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(f.tip_largest_mm, 2, 1e-9);
}

// Corners in another order count only where the order is not known.
TEST(PeerScore, TurnedCorners) {
  const PictureTruth truth = Truth();
  PeerAnswer answer{truth.corners_px, {}, 0};
  for (auto& [id, c] : answer.corners_px) std::rotate(c.begin(), c.begin() + 1, c.end());
  PeerScore strict(kCamera, kCollar), lenient(kCamera, kCollar);
  strict.Add(answer, truth);
  lenient.Add(answer, truth, true);
  EXPECT_EQ(strict.Figures("").tags_found, 0);
  EXPECT_EQ(lenient.Figures("").Recall(), 1);
  EXPECT_NEAR(lenient.Figures("").corner_rms_px, 0, 1e-9);
}

CompareRow SomeRow() {
  CompareRow row{"size", "side of a tag, px", 12, 2.2, true, {}};
  PeerFigures blind, sees;
  blind.name = "blind";
  blind.pictures = sees.pictures = 3;
  blind.tags = sees.tags = 9;
  sees.name = "sees";
  sees.tags_found = 7;
  sees.poses = 3;
  sees.false_poses = 1;
  sees.corner_rms_px = 0.1;
  sees.tip_rms_mm = 0.2;
  sees.depth_bias_mm = -0.05;
  sees.ms = 1.25;
  row.peers = {blind, sees};
  return row;
}

TEST(CompareRows, AreReadAsWritten) {
  const auto file = std::filesystem::path(testing::TempDir()) / "vision_rows" / "cases.jsonl";
  const std::string line = RowText(SomeRow());
  EXPECT_NE(line.find("\"tip_rms_mm\":null"), std::string::npos);  // of the blind one
  WriteTextFile(file, line + '\n' + line + '\n' + line.substr(0, 40));
  const auto rows = ReadRows(file);
  ASSERT_EQ(rows.size(), 2u);  // the third is torn
  EXPECT_EQ(RowText(rows[1]), line);
  WriteTextFile(file, line + "\n{\"sweep\": 3}\n");
  try {
    ReadRows(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cases.jsonl:2:"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(ReadRows(file.parent_path() / "absent.jsonl").empty());
}

TEST(CompareRows, TablesHaveDashesWhereNothingWasMeasured) {
  CompareRow larger = SomeRow();
  larger.value = 45;
  larger.peers[1].false_poses = 0;
  EXPECT_EQ(TipTable({SomeRow(), larger}),
            "| side of a tag, px | 12 | 45 |\n|---|---|---|\n| blind | – | – |\n"
            "| sees | 0.200 (1 false) | 0.200 |\n");
  EXPECT_EQ(RecallTable({SomeRow()}),
            "| side of a tag, px | 12 |\n|---|---|\n| blind | 0 |\n| sees | 78 |\n");
  const std::string all = CompareTable({SomeRow()});
  EXPECT_NE(all.find("| 12 | blind | – | – | – | – | – | 0 of 9 | 0 of 3 | 0 | 0.0 |"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("| 0.200 | -0.050 |"), std::string::npos) << all;
}

}  // namespace
}  // namespace flextip::bench
