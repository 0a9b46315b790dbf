// What the heads of estimate's and track's pages say, by totals that are known.
#include <gmock/gmock.h>

#include "pipeline/judge_estimates.h"
#include "pipeline/judge_track.h"

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

EstimateTotals Healthy() {
  return {.samples = 100,
          .ok = 100,
          .chi2_per_measurement = 1.02,
          .tip_sd_m = 1e-4,
          .force_across_sd_N = 0.02,
          .force_along_sd_N = 0.05};
}

TEST(JudgeEstimates, HealthyOnesAreGood) {
  const Judgement judged = JudgeEstimates(Healthy());
  EXPECT_EQ(judged.grade, Grade::kGood);
  EXPECT_THAT(judged.says, HasSubstr("found at 100 of 100 samples; the tip is known to 0.1 mm"));
  EXPECT_THAT(judged.reasons, IsEmpty());
  EXPECT_EQ(judged.command, "flextip export csv RESULT -o RESULT-tables");
}

TEST(JudgeEstimates, AMisfitBeyondTheNoiseIsNamed) {
  EstimateTotals totals = Healthy();
  totals.chi2_per_measurement = 9.0;
  const Judgement judged = JudgeEstimates(totals);
  EXPECT_EQ(judged.grade, Grade::kBeware);
  EXPECT_THAT(judged.reasons, ElementsAre(HasSubstr("by 3.0 times their stated noise")));
  EXPECT_THAT(judged.command, HasSubstr("flextip diagnose"));
}

TEST(JudgeEstimates, AnAbsurdMisfitIsNoAnswer) {
  EstimateTotals totals = Healthy();
  totals.chi2_per_measurement = 1'112'137.0;  // a camera whose pose nobody calibrated
  const Judgement judged = JudgeEstimates(totals);
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_THAT(judged.says, HasSubstr("contradict each other: the fit misses them by 1055 times"));
  EXPECT_THAT(judged.command, HasSubstr("flextip check"));
}

TEST(JudgeEstimates, FailuresCount) {
  EstimateTotals totals = Healthy();
  totals.ok = 95;
  totals.not_converged = 5;
  EXPECT_EQ(JudgeEstimates(totals).grade, Grade::kGood);
  EXPECT_THAT(JudgeEstimates(totals).reasons, ElementsAre(HasSubstr("5 of 100 samples")));
  totals.ok = 80;
  totals.not_converged = 20;
  EXPECT_EQ(JudgeEstimates(totals).grade, Grade::kBeware);
  totals.ok = 0;
  totals.not_converged = 100;
  EXPECT_EQ(JudgeEstimates(totals).grade, Grade::kNotFound);
}

TEST(JudgeEstimates, SaysWhyTheForceAlongTheShaftIsHardlyKnown) {
  EstimateTotals totals = Healthy();
  totals.force_along_sd_N = 1.3;
  const Judgement judged = JudgeEstimates(totals);
  EXPECT_EQ(judged.grade, Grade::kGood);
  EXPECT_THAT(judged.reasons, ElementsAre(HasSubstr("1.3 N along it: a force along the shaft "
                                                    "hardly bends it")));
}

TEST(TotalsOfEstimates, AreTheMediansAndSumsOfTheSamples) {
  Series<ShaftEstimate> estimates;
  for (int i = 0; i < 4; ++i) {
    ShaftEstimate e;
    e.status = i < 3 ? EstimateStatus::kOk : EstimateStatus::kNotConverged;
    e.d_RE = Eigen::Vector3d::UnitX();
    e.p_RE_covariance_m2 = 1e-6 * (i + 1) * (i + 1) * Eigen::Matrix3d::Identity();
    e.covariance.diagonal().tail<3>() << 4.0, 0.01, 0.01;
    e.chi2 = i < 3 ? 6.0 : 0.0;
    e.measurements = i < 3 ? 3 : 0;
    estimates.push_back({i, e});
  }
  const EstimateTotals totals = TotalsOf(estimates);
  EXPECT_EQ(totals.samples, 4);
  EXPECT_EQ(totals.ok, 3);
  EXPECT_EQ(totals.not_converged, 1);
  EXPECT_DOUBLE_EQ(totals.chi2_per_measurement, 2.0);
  EXPECT_NEAR(totals.tip_sd_m, 2e-3, 1e-12);
  EXPECT_NEAR(totals.force_along_sd_N, 2.0, 1e-12);
  EXPECT_NEAR(totals.force_across_sd_N, 0.1, 1e-12);
}

TEST(JudgeTrack, SaysWhereTheTipWasSeen) {
  const Judgement judged = JudgeTrack(
      {.frames = 60, .ok = 57, .predicted = 2, .lost = 1, .tags = 150, .family = "tag36h11"});
  EXPECT_EQ(judged.grade, Grade::kGood);
  EXPECT_EQ(judged.says, "The tip was seen in 57 of 60 frames, predicted in 2, lost in 1.");
  EXPECT_EQ(judged.command, "flextip estimate RECORDING --tracked RESULT -o RESULT-estimate");
  EXPECT_THAT(JudgeTrack({.frames = 60, .ok = 60, .has_wrist = false}).command,
              HasSubstr("flextip export csv RESULT"));
}

TEST(JudgeTrack, TheWrongFamilyIsNoAnswer) {
  const Judgement judged = JudgeTrack({.frames = 60, .lost = 60, .family = "tag25h9"});
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_EQ(judged.says, "No tag of the family tag25h9 was found in 60 frames.");
  EXPECT_THAT(judged.command, HasSubstr("flextip detect"));
}

TEST(JudgeTrack, TagsThatFitNoCollarAreNoAnswer) {
  const Judgement judged =
      JudgeTrack({.frames = 60, .lost = 60, .tags = 120, .family = "tag36h11"});
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_THAT(judged.says, HasSubstr("120 tags of the family tag36h11"));
}

TEST(JudgeTrack, TagsThatContradictTheWristAreNoAnswer) {
  TrackTotals totals{.frames = 60, .lost = 60, .tags = 120, .not_by_wrist = 58};
  totals.from_wrist_m = 0.045;
  totals.steady_part = 0.98;
  Judgement judged = JudgeTrack(totals);
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_EQ(judged.says, "No tip of 60 frames holds: their tags contradict wrist and shaft.");
  EXPECT_THAT(judged.reasons, ElementsAre(HasSubstr("in 58 frames the tags' tip is 45 mm from")));
  EXPECT_THAT(judged.reasons, ElementsAre(HasSubstr("camera file is of another camera")));
  EXPECT_THAT(judged.command, HasSubstr("flextip check RECORDING"));
  // Where the miss changes, it is no file's.
  totals.steady_part = 0.4;
  EXPECT_THAT(JudgeTrack(totals).reasons, ElementsAre(HasSubstr("clock is late")));
  // Some that hold are an answer, with care.
  totals.ok = 20;
  totals.lost = 40;
  judged = JudgeTrack(totals);
  EXPECT_EQ(judged.grade, Grade::kBeware);
  EXPECT_THAT(judged.says, HasSubstr("seen in 20 of 60 frames"));
  EXPECT_THAT(judged.command, HasSubstr("flextip check RECORDING"));
}

TEST(JudgeTrack, ACollarThatContradictsItselfAndStillPicturesAreNamed) {
  TrackTotals totals{.frames = 60, .ok = 40, .predicted = 20, .family = "tag36h11"};
  totals.stood_still = 20;
  EXPECT_THAT(JudgeTrack(totals).reasons, ElementsAre(HasSubstr("20 pictures are those before")));
  EXPECT_EQ(JudgeTrack(totals).grade, Grade::kBeware);
  totals.stood_still = 0;
  totals.ok = 0;
  totals.tags = 90;
  totals.not_by_collar = 50;
  const Judgement judged = JudgeTrack(totals);
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_EQ(judged.says, "No tip of 60 frames holds: their tags contradict the collar.");
  EXPECT_THAT(judged.command, HasSubstr("flextip detect PICTURE --family tag36h11"));
}

TEST(JudgeTrack, ACameraWithoutAPoseIsSaidSo) {
  const Judgement judged =
      JudgeTrack({.frames = 60, .ok = 60, .family = "tag36h11", .camera_has_pose = false});
  EXPECT_EQ(judged.grade, Grade::kBeware);
  EXPECT_THAT(judged.reasons, ElementsAre(HasSubstr("in the camera's frame")));
  EXPECT_THAT(judged.command, HasSubstr("flextip calibrate hand-eye"));
}

}  // namespace
}  // namespace flextip
