// Verdicts by results made up for them: the grade, its reasons, and what comes next.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/verdict/budget.h"
#include "calibration/verdict/camera.h"
#include "calibration/verdict/em.h"
#include "calibration/verdict/hand_eye.h"
#include "calibration/verdict/shaft.h"
#include "calibration/verdict/tip.h"

namespace flextip {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string ValueOf(const CalibrationVerdict& verdict, const std::string& name) {
  for (const auto& value : verdict.values) {
    if (value.name == name) return value.value;
  }
  return "absent";
}

TEST(Verdict, GoesDownButNeverUp) {
  CalibrationVerdict verdict;
  verdict.Mention("to know", false);
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_EQ(verdict.Judged(), "Good.");
  verdict.Beware("to be careful");
  EXPECT_EQ(verdict.grade, Grade::kBeware);
  EXPECT_EQ(verdict.Judged(), "To be used with care.");
  verdict.grade = Grade::kNotFound;
  verdict.Beware("more");
  EXPECT_EQ(verdict.grade, Grade::kNotFound);
  EXPECT_THAT(verdict.reasons, ElementsAre("to know", "to be careful", "more"));
}

TEST(Verdict, CountsMatterByTheirShare) {
  CalibrationVerdict verdict;
  verdict.MentionCount(0, 10, 0.1, "none");
  verdict.MentionCount(1, 10, 0.1, "a tenth");
  EXPECT_EQ(verdict.grade, Grade::kGood);
  verdict.MentionCount(2, 10, 0.1, "a fifth");
  EXPECT_EQ(verdict.grade, Grade::kBeware);
  EXPECT_THAT(verdict.reasons, ElementsAre("a tenth", "a fifth"));
  EXPECT_EQ(Counted(1, "view"), "1 view");
  EXPECT_EQ(Counted(3, "view"), "3 views");
  EXPECT_EQ(PlaceText({0.001, -0.02, 0}), "(1.00, -20.00, 0.00) mm");
}

TEST(Verdict, JoinsWhatOneReasonHides) {
  CalibrationVerdict verdict;
  verdict.not_found = {{"cam0.T_RC.p[0]", "one axis"},
                       {"cam0.T_RC.p[2]", "one axis"},
                       {"time_offset_s", "too slow"},
                       {"board.T_WB.p[0]", "one axis"}};
  const auto grouped = verdict.NotFoundByReason();
  ASSERT_EQ(grouped.size(), 2u);
  EXPECT_EQ(grouped[0].parameter, "cam0.T_RC.p, board.T_WB.p");
  EXPECT_EQ(grouped[0].reason, "one axis");
  EXPECT_EQ(grouped[1].parameter, "time_offset_s");
}

PivotResult GoodPivot() {
  PivotResult r;
  r.status = PivotStatus::kOk;
  r.residuals.resize(20);
  r.used = 20;
  r.rms_m = r.heldout_rms_m = 1e-4;
  r.covariance = 1e-8 * Matrix6d::Identity();
  r.p_BE = {0.1, 0, 0};
  r.advice = {Eigen::Vector3d::UnitY(), 0.5, 4, 1e-4};
  return r;
}

TEST(TipVerdict, IsGoodWhereAllPosesAgree) {
  const CalibrationVerdict verdict = JudgeTip(GoodPivot(), "tip.p_WE", "W");
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.reasons, IsEmpty());
  EXPECT_EQ(ValueOf(verdict, "tip in W, tip.p_WE"), "(100.00, 0.00, 0.00) mm");
  EXPECT_THAT(verdict.says, HasSubstr("Good. The tip is known to 0.17 mm"));
  EXPECT_THAT(verdict.next, HasSubstr("4 further poses turned by 29 deg"));
  EXPECT_THAT(verdict.next, HasSubstr("about the y axis of W"));
}

TEST(TipVerdict, SaysWhatIsWrong) {
  PivotResult r = GoodPivot();
  r.used = 19;
  EXPECT_EQ(JudgeTip(r, "tip.p_WE", "W").grade, Grade::kGood);
  EXPECT_THAT(JudgeTip(r, "tip.p_WE", "W").reasons, Contains(HasSubstr("1 pose put the tip")));
  r.used = 15;
  EXPECT_EQ(JudgeTip(r, "tip.p_WE", "W").grade, Grade::kBeware);
  r = GoodPivot();
  r.orientation_noise_scale = 3;
  EXPECT_THAT(JudgeTip(r, "tip.p_WE", "W").reasons, Contains(HasSubstr("scatter 3.0 times")));
  r = GoodPivot();
  r.heldout_rms_m = 2e-4;
  EXPECT_THAT(JudgeTip(r, "tip.p_WE", "W").reasons, Contains(HasSubstr("too few")));
}

TEST(TipVerdict, NamesWhatItDidNotFind) {
  PivotResult r;
  r.unobservable = "the poses hardly turn";
  const CalibrationVerdict verdict = JudgeTip(r, "tip.p_SE", "S");
  EXPECT_EQ(verdict.grade, Grade::kNotFound);
  ASSERT_EQ(verdict.NotFoundByReason().size(), 1u);
  EXPECT_EQ(verdict.NotFoundByReason()[0].parameter, "tip.p_SE, pivot.p_R");
  EXPECT_THAT(verdict.values, IsEmpty());
}

TEST(EmVerdict, BewaresOfALateSensorAndOfScatter) {
  EmResult r;
  r.status = EmStatus::kOk;
  r.residuals.resize(100);
  r.used = 100;
  r.noise_scale = 1.0;
  r.rms_after_m = 2e-4;
  r.solution.covariance = 1e-8 * Eigen::MatrixXd::Identity(7, 7);
  EXPECT_EQ(JudgeEm(r).grade, Grade::kGood);
  EXPECT_EQ(LagText(r), "");
  r.lag = {.late_s = 0.02, .sd_s = 0.001};
  EXPECT_THAT(JudgeEm(r).reasons, Contains(HasSubstr("the sensor is 20.0 ms behind")));
  EXPECT_THAT(JudgeEm(r).next, HasSubstr("clocks"));
  r.lag = {};
  r.noise_scale = 4;
  EXPECT_THAT(JudgeEm(r).reasons, Contains(HasSubstr("scatter 4.0 times")));
  EXPECT_EQ(JudgeEm(r).grade, Grade::kBeware);
  r.status = EmStatus::kUnobservable;
  r.message = "in a plane";
  EXPECT_EQ(JudgeEm(r).grade, Grade::kNotFound);
  EXPECT_THAT(JudgeEm(r).reasons, ElementsAre("in a plane"));
}

HandEyeResult GoodHandEye() {
  HandEyeResult r;
  r.status = HandEyeStatus::kOk;
  r.covariance = 1e-8 * Eigen::MatrixXd::Identity(12, 12);
  r.views.resize(10);
  for (auto& view : r.views) view.seen = view.used = true;
  r.views_used = 10;
  r.rms_px = r.held_out_px = 0.2;
  r.rms_mm = r.held_out_mm = 0.1;
  r.motions = {{"turn it about x", 1e-3, 5e-4}};
  return r;
}

TEST(HandEyeVerdict, JudgesViewsNoiseAndWhatIsKnown) {
  HandEyeResult r = GoodHandEye();
  const auto judge = [&] { return JudgeHandEye(r, HandEyeCalibration(r)); };
  EXPECT_EQ(judge().grade, Grade::kGood);
  EXPECT_THAT(judge().next,
              HasSubstr("sharper still: turn it about x (1.00 mm would become 0.50 mm for a point "
                        "on the board)"));
  EXPECT_THAT(judge().command, HasSubstr("--calibration RESULT/calibration.yaml"));
  EXPECT_NE(ValueOf(judge(), "camera in R, cam0.T_RC"), "absent");
  for (int i = 0; i < 3; ++i) r.views[static_cast<std::size_t>(i)].used = false;
  EXPECT_THAT(judge().reasons, Contains(HasSubstr("3 views did not agree")));
  EXPECT_EQ(judge().grade, Grade::kBeware);
  r = GoodHandEye();
  r.position_noise_scale = 5;
  EXPECT_THAT(judge().reasons, Contains(HasSubstr("the wrist scatters 5.0 times")));
  r = GoodHandEye();
  r.held_out_px = 0.4;
  EXPECT_THAT(judge().reasons, Contains(HasSubstr("2.0 times as far off")));
  r = GoodHandEye();
  r.knows_camera = false;
  EXPECT_EQ(judge().grade, Grade::kNotFound);
  EXPECT_THAT(judge().says, HasSubstr("not where the camera is"));
}

StrainCalibration GoodStrain() {
  StrainCalibration r;
  r.gages_known = r.offset_known = true;
  r.gains = 100 * Eigen::Matrix4d::Identity();
  r.gains(0, 1) = 2;
  r.gain_sd.setConstant(0.1);
  r.chi2_per_dof = 1.0;
  r.rms_Nm = r.heldout_rms_Nm = 1e-4;
  r.largest_moment_Nm = 0.01;
  r.holds.resize(12);
  for (auto& hold : r.holds) hold.used = true;
  return r;
}

TEST(StrainVerdict, JudgesScatterAndHeldOutLoads) {
  StrainCalibration r = GoodStrain();
  EXPECT_EQ(JudgeStrain(r).grade, Grade::kGood);
  EXPECT_EQ(ValueOf(JudgeStrain(r), "most cross-talk"), "2.00 %");
  EXPECT_THAT(JudgeStrain(r).says, HasSubstr("0.1 mNm, 1.0 % of the largest"));
  r.chi2_per_dof = 9;
  EXPECT_THAT(JudgeStrain(r).reasons, Contains(HasSubstr("scatter 3.0 times")));
  r = GoodStrain();
  r.heldout_rms_Nm = 3e-4;
  EXPECT_EQ(JudgeStrain(r).grade, Grade::kBeware);
  r.gages_known = false;
  EXPECT_EQ(JudgeStrain(r).grade, Grade::kNotFound);
}

TEST(StiffnessVerdict, DoubtsAModelThatDoesNotExplainTheShapes) {
  StiffnessCalibration r;
  r.status = StiffnessStatus::kOk;
  r.constant.emplace();
  r.constant->stiffness_Nm2 = 0.3;
  r.constant->stiffness_sd_Nm2 = 0.003;
  r.constant->chi2_per_dof = 1;
  r.port_noise_m = 3e-4;
  r.holds.resize(10);
  for (auto& hold : r.holds) hold.used = true;
  EXPECT_EQ(JudgeStiffness(r).grade, Grade::kGood);
  EXPECT_THAT(JudgeStiffness(r).says, HasSubstr("known to 1 %"));
  r.port_shift_m = {0, 0.002, 0};
  EXPECT_THAT(StiffnessDoubts(r), ElementsAre(HasSubstr("2.00 mm from where it is registered")));
  r.status = StiffnessStatus::kModelIncomplete;
  EXPECT_THAT(StiffnessDoubts(r), Contains(HasSubstr("something else gives way too")));
  EXPECT_EQ(JudgeStiffness(r).grade, Grade::kBeware);
  r.status = StiffnessStatus::kUnobservable;
  EXPECT_EQ(JudgeStiffness(r).grade, Grade::kNotFound);
}

CameraCalibrationResult GoodCamera() {
  CameraCalibrationResult r;
  r.status = CameraCalibrationStatus::kOk;
  r.solution.camera.distortion = Distortion::kOpenCv;
  r.solution.camera.distortion_coefficients = {0, 0, 0, 0, 0};
  r.solution.noise_px = 0.1;
  r.covariance = 0.01 * Eigen::MatrixXd::Identity(9, 9);
  r.views.resize(10);
  r.views_used = 10;
  return r;
}

CameraUncertainty Uncertain(double centre_px, double border_px) {
  CameraUncertainty u;
  u.near.depth_m = 0.3;
  u.near.sd_px.setConstant(3, 3, border_px);
  u.near.sd_px(1, 1) = centre_px;
  u.next = {{Pose(), 0.5, 0.25, "hold the board upright"}};
  return u;
}

TEST(CameraVerdict, JudgesCoverageAndHalves) {
  const CameraCalibrationResult r = GoodCamera();
  const CalibrationVerdict good = JudgeCamera(r, Uncertain(0.05, 0.1), {});
  EXPECT_EQ(good.grade, Grade::kGood);
  EXPECT_EQ(
      good.next,
      "give calibration.yaml to the commands on what this camera records; sharper still: hold "
      "the board upright (the mean would fall from 0.500 to 0.250 px)");
  EXPECT_EQ(ValueOf(good, "lens"), "opencv 5");
  EXPECT_EQ(ValueOf(good, "halves of the views differ by"), "absent");
  const CalibrationVerdict bare = JudgeCamera(r, Uncertain(0.05, 5), {});
  EXPECT_EQ(bare.grade, Grade::kBeware);
  EXPECT_THAT(bare.reasons, Contains(HasSubstr("hardly covered")));
  const CalibrationVerdict halves =
      JudgeCamera(r, Uncertain(0.05, 0.1), ProjectionDifference{.rms_px = 2, .max_px = 4});
  EXPECT_THAT(halves.reasons, Contains(HasSubstr("not as modelled")));
  EXPECT_EQ(halves.grade, Grade::kBeware);
}

TEST(CameraVerdict, TellsRejectedViewsAndABoardThatIsNotTrue) {
  CameraCalibrationResult r = GoodCamera();
  r.views_rejected = 1;
  r.solution.shape.sd_m = 1e-4;
  r.solution.shape.offset_B[0] = {1e-4, 0, 0};
  const CalibrationVerdict verdict = JudgeCamera(r, {}, {});
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.reasons, ElementsAre("1 view did not fit and do not count",
                                           HasSubstr("the board is not as described")));
  EXPECT_EQ(verdict.next, "give calibration.yaml to the commands on what this camera records");
  r.views_rejected = 4;
  EXPECT_EQ(JudgeCamera(r, {}, {}).grade, Grade::kBeware);
}

TEST(BudgetVerdict, SaysWhatToImproveAndWhatIsMissing) {
  const std::vector<BudgetPartSize> parts = {{"bending", 3, 2, false},
                                             {"lens", 0.5, 0.1, true},
                                             {"pixels", 0.2, 0.1, true},
                                             {"total", 0.54, 0.14, true}};
  const CalibrationVerdict verdict = JudgeBudget(parts, {}, 50);
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.next, HasSubstr("most is from the lens"));
  EXPECT_NE(ValueOf(verdict, "bending (if bending were corrected)"), "absent");
  EXPECT_THAT(verdict.says, HasSubstr("0.54 mm along"));
  const CalibrationVerdict missing = JudgeBudget(parts, {{"hand-eye", "not given"}}, 50);
  EXPECT_EQ(missing.grade, Grade::kBeware);
  EXPECT_THAT(missing.reasons, Contains(HasSubstr("1 part of the chain")));
  EXPECT_EQ(missing.not_found.at(0).parameter, "hand-eye");
}

// The library knows no command line.
TEST(Verdict, NamesNoOptions) {
  StiffnessCalibration r;
  r.constant.emplace();
  r.status = StiffnessStatus::kModelIncomplete;
  for (const std::string& doubt : StiffnessDoubts(r)) {
    EXPECT_THAT(doubt, Not(HasSubstr("--")));
    EXPECT_THAT(doubt, Not(HasSubstr("flextip ")));
  }
}

}  // namespace
}  // namespace flextip
