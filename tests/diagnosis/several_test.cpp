// Several recordings of one instrument together: what all share, what began, each one's answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>

#include "core/error.h"
#include "diagnosis/several/diagnose_several.h"
#include "diagnosis/several/joint_fit.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<NamedRecording> Named(const std::vector<hidden::HiddenRecording>& hidden) {
  std::vector<NamedRecording> named;
  for (std::size_t r = 0; r < hidden.size(); ++r)
    named.push_back({"day_" + std::to_string(r), hidden[r].recording});
  return named;
}

std::vector<NamedRecording> Series(std::vector<std::string> effects, std::vector<std::string> later,
                                   int begin, int recordings, std::uint64_t seed) {
  hidden::HiddenSeries series{.recordings = recordings, .later = std::move(later), .begin = begin};
  series.options.effects = std::move(effects);
  series.options.scene.duration_s = 8.0;
  return Named(hidden::MakeHiddenSeries(series, seed));
}

NormalSums RandomSums(int size, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd X(3 * size, size);
  Eigen::VectorXd z(3 * size);
  for (auto& x : X.reshaped()) x = normal(rng);
  for (auto& x : z) x = 2.0 * normal(rng);
  NormalSums sums(size);
  sums.H = X.transpose() * X;
  sums.g = X.transpose() * z;
  sums.c = z.squaredNorm();
  return sums;
}

/// log of the integral over all unknowns, each with a normal prior of deviation `sd`.
double LogIntegral(const NormalSums& sums, const Eigen::VectorXd& sd) {
  Eigen::MatrixXd A = sums.H;
  A.diagonal() += sd.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd prior = sd.cwiseAbs2().cwiseInverse().asDiagonal();
  return 0.5 * (sums.g.dot(A.ldlt().solve(sums.g)) - std::log(A.determinant()) +
                std::log(prior.determinant()) - sums.c - sums.volume);
}

TEST(ReducedSums, EvidenceOfTheRestIsThatOfAll) {
  std::mt19937 rng(3);
  const NormalSums sums = RandomSums(7, rng);
  const Eigen::VectorXd sd = Eigen::VectorXd::LinSpaced(7, 0.2, 2.0);
  const std::vector<int> kept{0, 3, 4, 6}, out{1, 2, 5};
  const NormalSums reduced = IntegratedOut(sums, kept, out, sd(out));
  EXPECT_NEAR(LogIntegral(reduced, sd(kept)), LogIntegral(sums, sd), 1e-9);
  // And the most likely values are those of all together.
  Eigen::MatrixXd A = sums.H;
  A.diagonal() += sd.cwiseAbs2().cwiseInverse();
  const Eigen::VectorXd all = A.ldlt().solve(sums.g);
  Eigen::MatrixXd B = reduced.H;
  B.diagonal() += Eigen::VectorXd(sd(kept)).cwiseAbs2().cwiseInverse();
  const Eigen::VectorXd rest = B.ldlt().solve(reduced.g);
  EXPECT_TRUE(rest.isApprox(Eigen::VectorXd(all(kept)), 1e-9));
  EXPECT_TRUE(BestOf(sums, kept, out, sd(out), rest).isApprox(Eigen::VectorXd(all(out)), 1e-9));
}

/// A single recording's evidence is worked out in another way.
TEST(JointEvidence, OfOneRecordingIsItsOwn) {
  const auto named = Series({"stiffness"}, {}, 1, 1, 41);
  Fleet fleet(named, {});
  StandAtBase(MemberWorkers(fleet));
  const JointEvidence joint = EvidenceHere(fleet);
  const Member& member = fleet.At(0);
  const Evidence alone(member.sums, member.layout, Eigen::VectorXd(), {.unknown_sd = {}});
  for (const Hypothesis& h :
       {Hypothesis{}, Hypothesis{{0}, false}, Hypothesis{{6}, false}, Hypothesis{{0, 12}, false}}) {
    const double expected = alone.Weigh(h).log_evidence + alone.LogEvidenceOfNone();
    EXPECT_NEAR(joint.Weigh({h.effects, {}, false}).log_evidence, expected,
                1e-6 * std::abs(expected));
  }
}

/// What is added by a change, worked out about a solved problem, is what weighing it says.
TEST(JointEvidence, AChangeIsWeighedTheSameInBothWays) {
  const auto named = Series({}, {"stiffness"}, 1, 3, 42);
  Fleet fleet(named, {});
  StandAtBase(MemberWorkers(fleet));
  const JointEvidence evidence = EvidenceHere(fleet);
  const JointWeighed none = evidence.Weigh({});
  int compared = 0;
  for (const auto& added : evidence.WithChanges(none)) {
    if (added.change.effect > 5) continue;
    JointHypothesis h;
    h.changes = {added.change};
    const double expected = evidence.Weigh(h).log_evidence;
    EXPECT_NEAR(none.log_evidence + added.log_gain, expected, 1e-6 * std::abs(expected));
    ++compared;
  }
  EXPECT_GE(compared, 6);
}

/// The change that is there already has a parameter of each recording's own, wide from the last
/// recording on alone.
TEST(JointEvidence, AChangeBesideOneOfOwnParametersIsWeighedTheSame) {
  const auto named = Series({}, {"strain_drift"}, 2, 3, 48);
  Fleet fleet(named, {});
  StandAtBase(MemberWorkers(fleet));
  const JointEvidence evidence = EvidenceHere(fleet);
  JointHypothesis drift;
  drift.changes = {{fleet.Layout().Find("strain_drift"), 2}};
  const JointWeighed beside = evidence.Weigh(drift);
  for (const auto& added : evidence.WithChanges(beside)) {
    if (added.change.effect > 5) continue;
    JointHypothesis both = drift;
    both.changes.push_back(added.change);
    // One way is at the drift's best width, the other averages over three: log 3 at most.
    EXPECT_NEAR(beside.log_evidence + added.log_gain, evidence.Weigh(both).log_evidence, 1.15)
        << added.change.effect << " from " << added.change.first;
  }
}

TEST(Several, WhatAllShareIsKnownBetterThanInOne) {
  const auto named = Series({"stiffness"}, {}, 1, 3, 43);
  const SeveralResult several = DiagnoseSeveral(named);
  const DiagnosisResult alone = Diagnose(named[0].recording, "alone");
  EXPECT_THAT(several.common.verdict, ElementsAre("stiffness"));
  EXPECT_THAT(several.names, ElementsAre("day_0", "day_1", "day_2"));
  EXPECT_THAT(several.changes, IsEmpty());
  ASSERT_EQ(several.own.size(), 3U);
  for (const DiagnosisResult& own : several.own) {
    EXPECT_THAT(own.verdict, ElementsAre("stiffness"));
    EXPECT_LT(own.extended.chi2_per_dof, 1.3);
  }
  const auto sd = [](const DiagnosisResult& result) {
    return result.parameters[0].parameters[0].sd[0];
  };
  EXPECT_LT(sd(several.common), sd(alone));
  EXPECT_LT(several.common.gain.heldout_error_ratio, 0.5);
  EXPECT_EQ(several.common.samples, 3 * alone.samples);
}

TEST(Several, FindsWhatBeganInTheThird) {
  const auto named = Series({}, {"stiffness"}, 2, 4, 44);
  const SeveralResult several = DiagnoseSeveral(named, {.measure_gain = false});
  EXPECT_THAT(several.common.verdict, ElementsAre("none"));
  ASSERT_EQ(several.changes.size(), 1U);
  EXPECT_EQ(several.changes[0].effect, "stiffness");
  EXPECT_EQ(several.changes[0].first_in, 2U);
  EXPECT_GT(several.changes[0].probability, 0.9);
  EXPECT_EQ(several.changes[0].parameters.at(0).name, "scale");
  EXPECT_THAT(several.own[1].verdict, ElementsAre("none"));
  EXPECT_THAT(several.own[2].verdict, ElementsAre("stiffness"));
  EXPECT_THAT(several.own[3].verdict, ElementsAre("stiffness"));
  EXPECT_THAT(JudgeSeveral(several).says, HasSubstr("stiffness began in day_2"));
}

TEST(Several, HealthyOnesHaveNoChange) {
  const SeveralResult several = DiagnoseSeveral(Series({}, {}, 1, 3, 45), {.measure_gain = false});
  EXPECT_THAT(several.common.verdict, ElementsAre("none"));
  EXPECT_THAT(several.changes, IsEmpty());
}

/// Breath has another phase each day, and is one cause.
TEST(Several, ABreathIsEachRecordingsOwn) {
  const SeveralResult several =
      DiagnoseSeveral(Series({"port_motion"}, {}, 1, 3, 46), {.measure_gain = false});
  EXPECT_THAT(several.common.verdict, ElementsAre("port_motion"));
  EXPECT_THAT(several.changes, IsEmpty());
  for (const DiagnosisResult& own : several.own) EXPECT_LT(own.extended.chi2_per_dof, 1.4);
}

/// Two helpers, as processes of their own have them: bytes alone go there and back.
class HelpedDiagnosis : public testing::Test {
 protected:
  Helpers Ask() {
    return {2, [this](const auto& requests, const auto& meanwhile) {
              meanwhile();
              std::vector<std::string> replies;
              for (std::size_t i = 0; i < 2; ++i) replies.push_back(helpers_[i](requests[i]));
              return replies;
            }};
  }
  std::vector<std::function<std::string(const std::string&)>> helpers_;
};

/// Of a breath, whose frequency is scanned and shared.
TEST_F(HelpedDiagnosis, IsTheSameAsAlone) {
  const auto named = Series({"port_motion"}, {}, 1, 4, 46);
  const DiagnoseOptions options{.plan = MotionLimits{.seconds = 5.0}};
  MemberServer one(named, options), two(named, options);
  int asked = 0;
  helpers_ = {[&](const std::string& request) { return ++asked, one.Reply(request); },
              [&](const std::string& request) { return two.Reply(request); }};
  const SeveralResult helped = DiagnoseSeveral(named, options, Ask());
  const SeveralResult alone = DiagnoseSeveral(named, options);
  EXPECT_GT(asked, 3);
  ASSERT_EQ(helped.own.size(), alone.own.size());
  EXPECT_EQ(helped.common.covariance, alone.common.covariance);
  EXPECT_EQ(helped.common.gain.heldout_error_ratio, alone.common.gain.heldout_error_ratio);
  for (std::size_t r = 0; r < alone.own.size(); ++r) {
    const DiagnosisResult &x = helped.own[r], &y = alone.own[r];
    EXPECT_EQ(x.presence, y.presence);
    EXPECT_EQ(x.credible_set, y.credible_set);
    EXPECT_EQ(x.residuals.rows, y.residuals.rows);
    EXPECT_EQ(x.residuals.present, y.residuals.present);
    EXPECT_EQ(x.noise_sd, y.noise_sd);
    EXPECT_EQ(x.start_ns, y.start_ns);
    EXPECT_EQ(x.summaries, y.summaries);
    EXPECT_EQ(x.extended.heldout_rms, y.extended.heldout_rms);
    EXPECT_EQ(x.plan.has_value(), r == 3);
  }
  EXPECT_EQ(helped.own[3].plan->places_m, alone.own[3].plan->places_m);
}

TEST_F(HelpedDiagnosis, SaysWhyAHelperCannotWork) {
  const auto named = Series({}, {}, 1, 2, 47);
  const auto refuse = [](const std::string&) { return MemberServer::Refusal("rank 1: no disk"); };
  helpers_ = {refuse, refuse};
  EXPECT_THAT([&] { DiagnoseSeveral(named, {}, Ask()); },
              testing::ThrowsMessage<WorkError>("rank 1: no disk"));
  // A helper's own members may fail where those of the first process do not.
  auto broken = named;
  broken[1].recording.instrument.bending_stiffness_Nm2 *= 1e-6;
  broken[0].recording.instrument = broken[1].recording.instrument;
  MemberServer server(broken, {});
  helpers_.front() = [&](const std::string& request) { return server.Reply(request); };
  EXPECT_THAT([&] { DiagnoseSeveral(named, {}, Ask()); },
              testing::ThrowsMessage<WorkError>(HasSubstr("day_1: the nominal instrument")));
}

TEST(Several, RefusesAnotherInstrument) {
  auto named = Series({}, {}, 1, 2, 47);
  named[1].recording.instrument.length_m += 0.01;
  const auto message = [&] {
    try {
      DiagnoseSeveral(named);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message(), HasSubstr("day_0 and day_1: instrument length_m"));
  named[1].recording.instrument = named[0].recording.instrument;
  named[1].recording.tolerances["stiffness.scale"] = {0.05};
  EXPECT_THAT(message(), HasSubstr("tolerances is {}"));
  named[1].recording = named[0].recording;
  EXPECT_THAT(message(), HasSubstr("day_0 and day_1 hold the same samples"));
}

TEST(OneSession, IsRefusedWhereASensorSaysSomethingElseOrTheWristIsElsewhere) {
  NamedRecording first = Series({}, {}, 1, 1, 47).front();
  NamedRecording next = first;
  next.name = "next";
  const auto refusal = [&]() -> std::string {
    try {
      RequireOneSession({first, next});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  auto& begin = next.recording.wrist0->samples.front().value.p_RW;
  begin = first.recording.wrist0->samples.back().value.p_RW + Eigen::Vector3d(0.004, 0, 0);
  EXPECT_EQ(refusal(), "");
  begin.x() += 0.002;
  EXPECT_THAT(refusal(), HasSubstr("day_0 and next: the wrist begins 0.006 m from where"));
  begin.x() -= 0.002;
  next.recording.em0->distance_from_tip_m += 0.001;
  EXPECT_THAT(refusal(), HasSubstr("day_0 and next: em0 distance_from_tip_m is"));
}

}  // namespace
}  // namespace flextip::diagnosis
