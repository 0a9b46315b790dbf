// The tracker with the shaft's outline while something covers the tags.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/vision/outline_scene.h"
#include "tests/vision/scope_scene.h"
#include "vision/outline/tip_outline.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

constexpr TimeNs kFrame_ns = 33'333'333;
constexpr int kFrames = 40, kFirstCovered = 5, kFirstBack = 34;

bool IsCovered(int i) { return i >= kFirstCovered && i < kFirstBack; }

Pose PoseAt(int i) {
  return ScopePose(
      0.2 + 0.1 * std::sin(0.1 * i), 0.25 + 0.1 * std::sin(0.05 * i),
      {0.003 * std::sin(0.15 * i), 0.004 * std::sin(0.11 * i), 0.003 * std::sin(0.07 * i)});
}

std::vector<Image> Pictures() {
  simulation::LaparoscopeOptions options = ScopeOptions(ScopeCamera());
  options.occluders = {CoverOfTheCollar(kFirstCovered, kFirstBack - 1)};
  const simulation::Laparoscope scope(ScopeCamera(), ScopeCollar(), options);
  std::vector<Image> pictures;
  for (int i = 0; i < kFrames; ++i) {
    pictures.push_back(scope.Render(BentScopeShaft(PoseAt(i), {10, -15}), i));
  }
  return pictures;
}

class TipTrackerOutline : public testing::Test {
 protected:
  static void SetUpTestSuite() { pictures_ = Pictures(); }
  static void TearDownTestSuite() { pictures_.clear(); }
  static TrackerOptions WithOutline() {
    TrackerOptions options;
    options.tube = TubeOf(ScopeCollar(), ScopeTube().diameter_m, true);
    return options;
  }
  static double Error(const TipTrack& track, int i) {
    return (track.tip.p_RE - PoseAt(i).p).norm();
  }
  static double Nees(const TipTrack& track, int i) {
    return PositionNees(track.tip.p_RE, track.tip.covariance_m2, PoseAt(i));
  }
  static std::vector<Image> pictures_;
};
std::vector<Image> TipTrackerOutline::pictures_;

TEST_F(TipTrackerOutline, CarriesATipWhoseTagsAreCovered) {
  TipTracker with(ScopeCamera(), ScopeCollar(), WithOutline()),
      without(ScopeCamera(), ScopeCollar());
  double nees = 0, worst_m = 0;
  for (int i = 0; i < kFrames; ++i) {
    const TipTrack track = with.Track(pictures_[i], i * kFrame_ns);
    const TipTrack blind = without.Track(pictures_[i], i * kFrame_ns);
    ASSERT_EQ(track.tip.status, IsCovered(i) ? TipStatus::kPredicted : TipStatus::kOk) << i;
    EXPECT_LT(Nees(track, i), 21.1) << i;  // 99.99 %
    if (!IsCovered(i)) {
      EXPECT_LT(Error(track, i), 1e-4) << i;
      continue;
    }
    EXPECT_TRUE(track.outline_used) << i;
    EXPECT_FALSE(track.tip.d_RE) << i;
    nees += Nees(track, i) / (kFirstBack - kFirstCovered);
    worst_m = std::max(worst_m, Error(track, i));
    // By its motion alone the tip is lost after three frames, and less certain before that.
    const bool soon = i < kFirstCovered + 3;
    EXPECT_EQ(blind.tip.status, soon ? TipStatus::kPredicted : TipStatus::kLost) << i;
    if (blind.tip.status == TipStatus::kPredicted) {
      EXPECT_LT(track.tip.covariance_m2.trace(), blind.tip.covariance_m2.trace()) << i;
    }
  }
  EXPECT_LT(worst_m, 1.5e-3);  // nearly all of it in depth
  // The outline's systematic errors are much the same in all frames: no more than the mean is told.
  EXPECT_LT(nees, 3);
  EXPECT_GT(nees, 0.1);
}

// Sixty frames of a tip that stands still say no more of its depth than one: the errors (width,
// light) are the same in all. Taken as independent they would make it eight times surer.
TEST_F(TipTrackerOutline, DoesNotGrowSureByRepetition) {
  simulation::LaparoscopeOptions options = ScopeOptions(ScopeCamera());
  options.occluders = {CoverOfTheCollar(2, 1000)};
  const simulation::Laparoscope scope(ScopeCamera(), ScopeCollar(), options);
  std::vector<Image> pictures;
  for (int i = 0; i < 10; ++i)
    pictures.push_back(scope.Render(BentScopeShaft(PoseAt(8), {10, -15}), i));
  TipTracker tracker(ScopeCamera(), ScopeCollar(), WithOutline());
  const Eigen::Vector3d sight = ScopeCamera().T_RC.R.col(2);
  constexpr int kStill = 62;
  constexpr TimeNs kShort_ns = 5'000'000;
  double sd = 0;
  for (int i = 0; i < kStill; ++i) {
    const TipTrack track = tracker.Track(pictures[i < 2 ? i : 2 + i % 8], i * kShort_ns);
    ASSERT_EQ(track.tip.status, i < 2 ? TipStatus::kOk : TipStatus::kPredicted) << i;
    sd = std::sqrt(sight.dot(track.tip.covariance_m2 * sight));
  }
  TipOutline alone({ScopeCamera()}, *WithOutline().tube, {});
  TipPrediction expected{PoseAt(8), 1e-4 * Eigen::Matrix<double, 6, 6>::Identity()};
  expected.covariance.topLeftCorner<3, 3>() *= 100;
  const auto once = alone.Find({&pictures[5]}, expected);
  ASSERT_TRUE(once);
  EXPECT_GT(sd, 0.9 * std::sqrt(sight.dot(once->covariance.bottomRightCorner<3, 3>() * sight)));
}

// An outline that is not where the tags say (another diameter, another end) is never believed.
TEST_F(TipTrackerOutline, AWrongShaftDoesNoHarm) {
  for (const double diameter_m : {0.0035, 0.0042, 0.005, 0.0055, 0.0065}) {
    for (const bool round : {true, false}) {
      if (diameter_m == 0.005 && round) continue;  // the true one
      TrackerOptions options;
      options.tube = TubeOf(ScopeCollar(), diameter_m, round);
      TipTracker tracker(ScopeCamera(), ScopeCollar(), options);
      for (int i = 0; i < kFirstCovered + 6; ++i) {
        const TipTrack track = tracker.Track(pictures_[i], i * kFrame_ns);
        EXPECT_FALSE(track.outline_used) << diameter_m << round << i;
        EXPECT_EQ(track.tip.status == TipStatus::kOk, !IsCovered(i)) << diameter_m << round << i;
      }
    }
  }
}

TEST_F(TipTrackerOutline, GivesUpAfterItsTime) {
  TrackerOptions options = WithOutline();
  options.max_outline_ns = 10 * kFrame_ns;
  TipTracker tracker(ScopeCamera(), ScopeCollar(), options);
  for (int i = 0; i < kFirstBack; ++i) {
    const TipTrack track = tracker.Track(pictures_[i], i * kFrame_ns);
    if (i >= kFirstCovered && i < kFirstCovered + 10) {
      EXPECT_TRUE(track.outline_used) << i;
    }
    if (i > kFirstCovered + 12) {
      EXPECT_EQ(track.tip.status, TipStatus::kLost) << i;
    }
  }
}

// A model with a constant error and the covariance that says so: the outline mends what it sees.
TEST_F(TipTrackerOutline, MendsAModelsPrediction) {
  TipTracker tracker(ScopeCamera(), ScopeCollar(), WithOutline());
  TipPrediction model;
  model.covariance.diagonal() << 4e-4, 4e-4, 4e-4, 1e-6, 1e-6, 1e-6;
  for (int i = 0; i < kFirstBack; ++i) {
    model.T_RE = PoseAt(i);
    const Eigen::Vector3d off = ScopeCamera().T_RC.R * Eigen::Vector3d(0.0006, -0.0008, 0.0007);
    model.T_RE.p += off;
    const TipTrack track = tracker.Track(pictures_[i], i * kFrame_ns, model);
    if (i < kFirstCovered + 4) continue;  // what is left of the motion is spent
    if (!IsCovered(i)) continue;
    EXPECT_TRUE(track.outline_used) << i;
    EXPECT_LT(Nees(track, i), 16.3) << i;
    const Eigen::Vector3d e_C = ScopeCamera().T_RC.R.transpose() * (track.tip.p_RE - PoseAt(i).p);
    EXPECT_LT(e_C.head<2>().norm(), 3e-4) << i;  // 1 mm without the outline
  }
}

}  // namespace
}  // namespace flextip
