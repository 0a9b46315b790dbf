// A shaft that an arm holds: an arm by forces in time carries the plant's wrist, and what is put
// into either is found in one diagnosis.
#include "arms/held_shaft/held_shaft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "arms/held_shaft/diagnose_held.h"
#include "core/error.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/samples/sample_set.h"
#include "testdata/held_arm/arm_carrier.h"
#include "testdata/hidden/recording.h"

namespace flextip::arms {
namespace {

using simulation::ArmFaults;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

struct Hidden {
  std::vector<std::string> effects = {};
  ArmFaults faults = {};
  bool keep_wrist = true;
  std::uint64_t seed = 5;
};

Recording Make(const Hidden& what) {
  hidden::ArmCarrier carrier(simulation::SmallArm(), what.faults, what.keep_wrist, what.seed);
  hidden::HiddenOptions options{.effects = what.effects, .carrier = &carrier};
  options.scene.motion = hidden::MotionKind::kSines;
  options.scene.load = hidden::LoadKind::kVarying;
  options.scene.duration_s = 12.0;
  return hidden::MakeHidden(options, what.seed).recording;
}

diagnosis::DiagnosisResult DiagnosisOf(const Recording& recording) {
  const HeldShaft held(recording, "held");
  return diagnosis::Diagnose(held.WithWrist(), "held",
                             {.own_effects = held.Effects(), .discover = false});
}

/// Every derivative that an effect writes, against differences of the inputs that it writes.
TEST(HeldShaft, EffectsKnowTheirDerivatives) {
  const HeldShaft held(Make({.keep_wrist = false}), "held");
  diagnosis::SampleSet samples = diagnosis::MakeSampleSet(held.WithWrist(), "held");
  for (const auto& make : held.Effects()) {
    const auto effect = make();
    const auto parameters = effect->Parameters(samples);
    Eigen::VectorXd theta(Eigen::Index(parameters.size()));
    for (std::size_t j = 0; j < parameters.size(); ++j)
      theta[Eigen::Index(j)] =
          (j % 2 == 0 || parameters[j].positive ? 0.4 : -0.2) * parameters[j].typical;
    const auto inputs_at = [&](const Eigen::VectorXd& at,
                               std::vector<diagnosis::InputChange::Column>& columns) {
      diagnosis::EffectMemory memory{};
      diagnosis::SampleInputs inputs;
      for (std::size_t k = 0; k <= 100; k += 5) {
        inputs.setZero();
        columns.clear();
        diagnosis::InputChange change(at.data(), 0, inputs, columns);
        effect->Apply(at.data(), {samples, k, samples.samples[k].t_s}, memory, change);
      }
      return inputs;
    };
    std::vector<diagnosis::InputChange::Column> columns, unused;
    inputs_at(theta, columns);
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const double h = 1e-4 * parameters[std::size_t(j)].typical;
      Eigen::VectorXd up = theta, down = theta;
      up[j] += h;
      down[j] -= h;
      const diagnosis::SampleInputs by =
          (inputs_at(up, unused) - inputs_at(down, unused)) / (2.0 * h);
      diagnosis::SampleInputs own = diagnosis::SampleInputs::Zero();
      for (const auto& column : columns)
        if (column.parameter == j) own[column.input] += column.value;
      EXPECT_LT((own - by).norm(), 1e-5 * (by.norm() + 1e-3)) << effect->Name() << " by " << j;
    }
  }
}

TEST(HeldShaft, HasItsWristByTheJoints) {
  const Recording with = Make({.seed = 6});
  Recording without = with;
  without.wrist0.reset();
  const HeldShaft held(without, "held");
  ASSERT_TRUE(held.WithWrist().wrist0);
  for (std::size_t k = 0; k < with.wrist0->samples.size(); k += 50) {
    EXPECT_LT((held.WithWrist().wrist0->samples[k].value.p_RW - with.wrist0->samples[k].value.p_RW)
                  .norm(),
              1e-9);
  }
  // A wrist that the shaft hangs in freely has an orientation of its own.
  EXPECT_FALSE(held.WithWrist().wrist0->samples.front().value.q_RW);
  EXPECT_THAT(held.Warnings(), ElementsAre(testing::HasSubstr("off the port")));
  EXPECT_THAT(HeldShaft(with, "held").Warnings(), IsEmpty());
  Recording shifted = with;
  for (auto& sample : shifted.wrist0->samples) sample.value.p_RW.x() += 0.004;
  EXPECT_THAT(HeldShaft(shifted, "held").Warnings(),
              ElementsAre(testing::HasSubstr("wrist0 is 4 mm from where joints0")));
}

TEST(HeldShaft, WhatLacksJointsIsLeftOutOrRefused) {
  Recording recording = Make({.seed = 6});
  auto& rows = recording.joints0->q;
  rows.resize(rows.size() - 60);
  const HeldShaft held(recording, "held");
  EXPECT_THAT(held.Warnings(), ElementsAre(testing::HasSubstr("59 of 600 samples of wrist0")));
  EXPECT_EQ(held.WithWrist().wrist0->samples.size(), 541U);
  EXPECT_THROW(DiagnoseHeld(held, held.WithWrist(), "held", {.plan = diagnosis::MotionLimits{}}),
               InputError);
  for (auto& row : rows) row.t_ns += 3'600'000'000'000;
  EXPECT_THROW(HeldShaft(recording, "held"), InputError);
}

TEST(HeldShaft, TheAnswersOfBothPartsAreMultiplied) {
  diagnosis::DiagnosisResult shaft, arm;
  shaft.probabilities = {{{"stiffness"}, 0.8, 0.0}, {{"none"}, 0.2, 0.0}};
  shaft.presence = {{"stiffness", 0.8}};
  shaft.indistinguishable = {{"stiffness"}};
  arm.probabilities = {{{"servo_lag"}, 0.6, 0.0}, {{"none"}, 0.3, 0.0}, {{"unknown"}, 0.1, 0.0}};
  arm.presence = {{"servo_lag", 0.6}};
  arm.indistinguishable = {{"servo_lag", "command_latency"}};
  const auto both = Together(shaft, arm);
  EXPECT_THAT(both.verdict, ElementsAre("servo_lag", "stiffness"));
  std::map<diagnosis::Verdict, double> p;
  for (const auto& h : both.probabilities) p[h.verdict] = h.probability;
  EXPECT_NEAR((p[{"servo_lag", "stiffness"}]), 0.48, 1e-12);
  EXPECT_NEAR(p[{"stiffness"}], 0.24, 1e-12);
  EXPECT_NEAR(p[{"servo_lag"}], 0.12, 1e-12);
  EXPECT_NEAR(p[{"none"}], 0.06, 1e-12);
  EXPECT_NEAR(p[{"unknown"}], 0.1, 1e-12);
  EXPECT_EQ(both.credible_set.size(), 4U);  // 0.48 + 0.24 + 0.12 + 0.1
  EXPECT_EQ(both.presence.at("servo_lag"), 0.6);
  EXPECT_EQ(both.indistinguishable.size(), 2U);
  // What both parts name has one group.
  EXPECT_EQ(Together(both, arm).indistinguishable.size(), 2U);
}

TEST(HeldShaft, HealthyOnesHaveNoCause) {
  for (const std::uint64_t seed : {5, 6})
    EXPECT_THAT(DiagnosisOf(Make({.seed = seed})).verdict, ElementsAre("none")) << seed;
}

TEST(HeldShaft, TheShaftsCauseIsNamed) {
  EXPECT_THAT(DiagnosisOf(Make({.effects = {"stiffness"}})).verdict, ElementsAre("stiffness"));
}

TEST(HeldShaft, APlayOfAJointIsNamed) {
  const auto result = DiagnosisOf(Make({.faults = {.play = Eigen::Vector3d(0.0, 0.03, 0.0)}}));
  EXPECT_THAT(result.verdict, ElementsAre("joint_backlash"));
  EXPECT_NEAR(result.parameters.front().parameters.front().value[1], 0.03, 0.002);
}

TEST(HeldShaft, BothAreNamedTogether) {
  const auto result = DiagnosisOf(
      Make({.effects = {"stiffness"}, .faults = {.play = Eigen::Vector3d(0.0, 0.03, 0.0)}}));
  EXPECT_THAT(result.verdict, ElementsAre("joint_backlash", "stiffness"));
}

TEST(HeldShaft, AnOffsetIsNamedOrWhatItCannotBeToldFrom) {
  const auto result =
      DiagnosisOf(Make({.faults = {.encoder_offset = Eigen::Vector3d(0.0, 0.02, 0.0)}}));
  std::vector<std::string> could_be = result.verdict;
  for (const auto& group : result.indistinguishable)
    could_be.insert(could_be.end(), group.begin(), group.end());
  EXPECT_THAT(could_be, Contains("joint_offset"));
}

}  // namespace
}  // namespace flextip::arms
