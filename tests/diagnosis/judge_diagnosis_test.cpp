#include "diagnosis/judge_diagnosis.h"

#include <gmock/gmock.h>

namespace flextip::diagnosis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

DiagnosisResult Found() {
  DiagnosisResult result;
  result.verdict = {"length"};
  result.probabilities = {{{"length"}, 0.72, 0.0}, {{"tag_offset"}, 0.2, 0.0}};
  result.converged = true;
  result.extended.chi2_per_dof = 1.1;
  return result;
}

TEST(JudgeDiagnosis, SaysTheAnswerAndItsAlternatives) {
  DiagnosisResult result = Found();
  EXPECT_EQ(JudgeDiagnosis(result).says, "length (72 %).");
  EXPECT_EQ(JudgeDiagnosis(result).grade, Grade::kGood);
  result.indistinguishable = {{"length", "tag_offset"}};
  result.separating_motion = "a full turn about the shaft";
  result.separating_motion_score = 30.0;
  const Judgement judged = JudgeDiagnosis(result);
  EXPECT_EQ(judged.says, "length (72 %); length could as well be tag_offset.");
  EXPECT_THAT(judged.next, HasSubstr("record a full turn about the shaft"));
  result.separating_motion_score = 3.0;  // not enough
  EXPECT_THAT(JudgeDiagnosis(result).next, HasSubstr("a further sensor may"));
  EXPECT_THAT(judged.reasons, IsEmpty());
}

TEST(JudgeDiagnosis, WarningsAndARestlessSearchAreReasonsToBeCareful) {
  DiagnosisResult result = Found();
  result.warnings = {"3 of 400 samples are far"};
  result.converged = false;
  const Judgement judged = JudgeDiagnosis(result);
  EXPECT_EQ(judged.grade, Grade::kBeware);
  EXPECT_THAT(judged.reasons,
              ElementsAre("3 of 400 samples are far", HasSubstr("did not come to rest")));
}

TEST(JudgeDiagnosis, AnAbsurdMisfitIsNoAnswer) {
  DiagnosisResult result = Found();
  result.extended.chi2_per_dof = 1e6;
  const Judgement judged = JudgeDiagnosis(result);
  EXPECT_EQ(judged.grade, Grade::kNotFound);
  EXPECT_THAT(judged.says, HasSubstr("by 1000 times their noise"));
  EXPECT_EQ(judged.command, "flextip check RECORDING -o RESULT-check");
}

// A stream in another unit can pass for noise: then the noise is absurd.
TEST(JudgeDiagnosis, AnAbsurdNoiseIsNoAnswer) {
  DiagnosisResult result = Found();
  result.noise_scale = {1.0, 5000.0};
  EXPECT_EQ(JudgeDiagnosis(result).grade, Grade::kNotFound);
  result.noise_scale = {1.0, 5.0};
  EXPECT_EQ(JudgeDiagnosis(result).grade, Grade::kGood);
}

TEST(JudgeDiagnosis, SaysWhatToDoWithTheAnswer) {
  DiagnosisResult result = Found();
  EXPECT_EQ(JudgeDiagnosis(result).command,
            "flextip estimate RECORDING --model RESULT/model.yaml -o RESULT-estimate");
  result.gain.measured = true;
  result.gain.heldout_error_ratio = 1.02;  // the model is no better
  EXPECT_EQ(JudgeDiagnosis(result).command, "flextip estimate RECORDING -o RESULT-estimate");
  result.verdict = {"none"};
  EXPECT_EQ(JudgeDiagnosis(result).next, "keep the base simulation");
  result.verdict = {"unknown"};
  EXPECT_THAT(JudgeDiagnosis(result).next, HasSubstr("residual patterns"));
}

TEST(JudgeDiagnosis, AModelThatMissesSomethingIsLikeliestAmongTheKnownAlone) {
  DiagnosisResult result = Found();
  result.memory.correlation = 0.7;
  EXPECT_FALSE(result.IsAdequate());
  EXPECT_EQ(JudgeDiagnosis(result).says, "length (72 % among the known causes).");
  result.probabilities[0].probability = 0.9996;
  EXPECT_EQ(JudgeDiagnosis(result).says, "length (the likeliest of the known causes).");
}

TEST(JudgeDiagnosis, AHealthyRecordingMayRememberLessThanItsNoise) {
  DiagnosisResult result = Found();
  result.verdict = {"none"};
  result.memory.correlation = 0.98;
  result.memory.slow_variance = 0.3;
  EXPECT_TRUE(result.IsAdequate());
  result.memory.slow_variance = 3.0;
  EXPECT_FALSE(result.IsAdequate());
  result.verdict = {"unknown"};  // says itself that more is in the data
  EXPECT_TRUE(result.IsAdequate());
}

TEST(JudgeDiagnosis, NoAnswerIsCertain) {
  DiagnosisResult result = Found();
  result.probabilities[0].probability = 0.99962;
  EXPECT_EQ(JudgeDiagnosis(result).says, "length (over 99 %).");
}

}  // namespace
}  // namespace flextip::diagnosis
