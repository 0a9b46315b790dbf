#include "report/diagnose/words.h"
#include "tests/report/diagnose_fixture.h"

namespace flextip::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class DiagnoseHeadline : public DiagnosePage {
 protected:
  Headline Of(const Json& diagnosis) const {
    Write("diagnosis.json", diagnosis.dump());
    return MakeHeadline(ReadDiagnosedResult(folder_ / "diagnosis.json"));
  }
};

TEST_F(DiagnoseHeadline, SaysCauseSizeProbabilityAndGain) {
  const auto headline = Of(Friction());
  EXPECT_EQ(headline.verdict,
            "The shaft rubs in the port, and sticks: coefficient 0.213 ± 0.011 (98 %).");
  EXPECT_EQ(headline.gain,
            "On held-out data the extended model's error is 0.11 of the base's (90 % interval 0.09 "
            "to 0.13); the tip's prediction improves from 0.9 mm to 0.14 mm.");
  EXPECT_THAT(headline.causes, IsEmpty());
  EXPECT_EQ(headline.advice, "");
}

// A ratio to a width that is nearly none is large, and says nothing.
TEST_F(DiagnoseHeadline, SaysOfAnArmWhichJointAndWhatIsSure) {
  auto json = Friction();
  json["verdict"] = "joint_backlash";
  json["verdicts"] = {"joint_backlash"};
  json["probabilities"] = {{"joint_backlash", 0.98}, {"none", 0.02}, {"unknown", 0.0}};
  json["indistinguishable"] = {{"joint_backlash"}};
  json["summaries"] = {{"joint_backlash", "play drags other joints"}};
  json["parameters"] = {
      {"joint_backlash",
       {{"width",
         {{"value", {0.001, 0.25, 0.37}}, {"sd", {0.0004, 0.01, 0.02}}, {"nominal", {0, 0, 0}}}},
        {"drag",
         {{"value", {13.0, 0.1, 2.0, -0.9, 4.0, 0.0}},
          {"sd", {53.0, 0.2, 9.0, 0.1, 8.0, 0.1}},
          {"nominal", {0, 0, 0, 0, 0, 0}}}}}}};
  EXPECT_EQ(Of(json).verdict,
            "Play drags other joints: drag of joint 2 by joint 3 -0.90 ± 0.10 and width of joint 3 "
            "0.370 ± 0.020 (98 %).");
}

TEST_F(DiagnoseHeadline, SaysOfNoneWhetherOnlyNoiseIsLeft) {
  auto json = Friction();
  json["verdict"] = "none";
  json["verdicts"] = {"none"};
  json["probabilities"] = {{"none", 0.97}, {"port_friction", 0.02}, {"unknown", 0.01}};
  json["indistinguishable"] = {{"none"}};
  json["parameters"] = Json::object();
  json["base"]["chi2_per_dof"] = 1.02;
  auto headline = Of(json);
  EXPECT_THAT(headline.verdict, HasSubstr("Nothing is wrong beyond tolerance"));
  EXPECT_THAT(headline.verdict, HasSubstr("(97 %)"));
  EXPECT_THAT(headline.gain, HasSubstr("1.02"));
  EXPECT_THAT(headline.gain, HasSubstr("No extension is needed"));

  json["base"]["chi2_per_dof"] = 3.0;  // the noise does not fit the verdict
  EXPECT_THAT(Of(json).gain, HasSubstr("Yet chi-squared is 3.00"));
  json["probabilities"] = {{"none", 0.6}, {"port_friction", 0.38}, {"unknown", 0.02}};
  headline = Of(json);
  EXPECT_THAT(headline.verdict, HasSubstr("Probably nothing"));
  EXPECT_EQ(headline.runner_up, "Next likely: port friction, 38 %.");
}

TEST_F(DiagnoseHeadline, NamesNoCauseWhereItIsUnknown) {
  auto json = Friction();
  json["verdict"] = "unknown";
  json["verdicts"] = {"unknown"};
  json["probabilities"] = {{"none", 1e-4}, {"port_friction", 0.04}, {"unknown", 0.96}};
  json["indistinguishable"] = {{"unknown"}};
  const auto headline = Of(json);
  EXPECT_THAT(headline.verdict, HasSubstr("nothing in the catalogue explains it (96 %)"));
  EXPECT_THAT(headline.verdict, HasSubstr("EM position, which depends on sliding velocity"));
  EXPECT_THAT(headline.verdict, Not(HasSubstr("friction")));
  EXPECT_THAT(headline.gain, HasSubstr("no extended model to trust"));
}

TEST_F(DiagnoseHeadline, GivesAllThatCannotBeToldApartAndTheMotion) {
  auto json = Friction();
  json["verdict"] = "hand_eye";
  json["verdicts"] = {"hand_eye"};
  json["probabilities"] = {{"none", 0.01}, {"hand_eye", 0.52}, {"tag_offset", 0.40}};
  json["indistinguishable"] = Json::parse(R"([["hand_eye", "tag_offset"]])");
  json["separating_motion"] = "roll the instrument by 90 degrees";
  const auto headline = Of(json);
  EXPECT_EQ(headline.verdict, "One of these, and this recording cannot tell which (92 %):");
  EXPECT_THAT(headline.causes,
              ElementsAre("the camera is not where it was registered (hand eye), alone 52 %",
                          "the tag mount's place on the tip is off (tag offset), alone 40 %"));
  EXPECT_EQ(headline.advice, "To tell them apart: roll the instrument by 90 degrees.");
}

TEST_F(DiagnoseHeadline, NamesBothOfAPair) {
  auto json = Friction();
  json["verdicts"] = {"port_friction", "hand_eye"};
  json["probabilities"] = {{"hand_eye+port_friction", 0.94}, {"port_friction", 0.03}};
  json["indistinguishable"] = {{"port_friction"}, {"hand_eye"}};
  // A vector is said by its length, 5 mrad; its deviation is that along it.
  json["parameters"]["hand_eye"] = {
      {"rotation_rad", {{"value", {0.003, 0.0, 0.004}}, {"sd", {0.0005, 0.9, 0.0005}}}}};
  auto headline = Of(json);
  EXPECT_EQ(headline.verdict, "Two effects at once (94 %):");
  EXPECT_THAT(headline.causes,
              ElementsAre("the shaft rubs in the port, and sticks: coefficient 0.213 ± 0.011",
                          "the camera is not where it was registered: rotation 5.0 ± 0.5 mrad"));

  json["indistinguishable"] = {{"port_friction"}, {"hand_eye", "tag_offset"}};
  json["probabilities"] = {{"hand_eye+port_friction", 0.5}, {"port_friction+tag_offset", 0.45}};
  headline = Of(json);
  EXPECT_EQ(headline.verdict, "Two effects at once (95 %):");
  EXPECT_THAT(headline.causes.at(1), HasSubstr("either the camera is not where it was registered "
                                               "(hand eye) or the tag mount's"));
}

TEST_F(DiagnoseHeadline, DoesNotClaimWhatTheDataDoNotHold) {
  auto json = Friction();
  json["probabilities"] = {{"none", 0.3}, {"port_friction", 0.41}, {"unknown", 0.29}};
  json["gain"] = {{"heldout_error_ratio", 0.93}, {"heldout_error_ratio_interval", {0.8, 1.1}}};
  auto headline = Of(json);
  EXPECT_THAT(headline.verdict, testing::StartsWith("Not sure, but most likely: the shaft rubs"));
  EXPECT_THAT(headline.gain, HasSubstr("the gain is not certain"));
  EXPECT_EQ(headline.runner_up, "Next likely: none, 30 %.");
  json["gain"] = {{"heldout_error_ratio", 1.04}};
  EXPECT_THAT(Of(json).gain, HasSubstr("no better than the base simulation"));
  auto unmeasured = json;
  unmeasured.erase("gain");
  EXPECT_THAT(Of(unmeasured).gain, HasSubstr("was not measured"));
  json["base"]["heldout_rms"] = Json::object();  // a ratio of nothing
  EXPECT_THAT(Of(json).gain, HasSubstr("was not measured"));
}

TEST_F(DiagnoseHeadline, AModelThatMissesSomethingIsLikeliestAmongTheKnownAlone) {
  auto json = Friction();
  json["adequate"] = false;
  json["probabilities"]["port_friction"] = 0.9996;
  EXPECT_EQ(
      Of(json).verdict,
      "The likeliest of the known causes: the shaft rubs in the port, and sticks: coefficient "
      "0.213 ± 0.011.");
  json["probabilities"]["port_friction"] = 0.68;
  EXPECT_THAT(Of(json).verdict, HasSubstr("0.213 ± 0.011 (68 % among them)."));
}

TEST(DiagnoseWords, SayNumbersAsPeopleReadThem) {
  EXPECT_EQ(Percent(0.9999), "> 99 %");
  EXPECT_EQ(Percent(0.981), "98 %");
  EXPECT_EQ(Percent(0.004), "0.4 %");
  EXPECT_EQ(Percent(0.0), "< 0.1 %");
  EXPECT_EQ(WithDeviation(0.21342, 0.0098, ""), "0.213 ± 0.010");
  EXPECT_EQ(WithDeviation(12.344, 0.52, "mm"), "12.3 ± 0.5 mm");
  EXPECT_EQ(WithDeviation(153.2, 12.0, "N"), "153 ± 12 N");
  EXPECT_EQ(WithDeviation(0.5, 0.0, "N"), "0.5 N");
  EXPECT_EQ(ShownUnitOf("compliance_m_N").unit, "mm/N");
  EXPECT_EQ(ShownUnitOf("mass_per_length_kg_m").name, "mass per length");
  EXPECT_EQ(ShownUnitOf("delay_s").per_si, 1e3);
  EXPECT_EQ(ShownUnitOf("stiffness_Nm_rad").unit, "N m/rad");
  EXPECT_EQ(SpokenChannel("vision0_position_m"), "tip by vision");
  EXPECT_EQ(SpokenChannel("em0_orientation_rad"), "EM direction");
}

}  // namespace
}  // namespace flextip::report
