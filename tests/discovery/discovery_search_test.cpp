// What is found in residuals with a known term, and in noise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "diagnosis/discovery/certify.h"
#include "diagnosis/discovery/discover.h"
#include "diagnosis/discovery/library.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

/// A replay of the base simulation of an exact recording, whose readings `disturb` changed.
struct BaseReplay {
  SampleSet samples;
  ParameterLayout layout;
  Replay replay;

  template <class Disturb>
  BaseReplay(double duration_s, std::uint64_t seed, Disturb disturb)
      : samples(Disturbed(duration_s, seed, disturb)),
        layout(samples, MakeCatalogue(samples)),
        replay(samples, layout) {
    replay.Evaluate(Eigen::VectorXd::Zero(layout.Size()));
    replay.FixNoiseModel();
  }

  template <class Disturb>
  static SampleSet Disturbed(double duration_s, std::uint64_t seed, Disturb disturb) {
    Recording recording = SmallHidden(duration_s, true, seed).recording;
    disturb(recording);
    return MakeSampleSet(recording, "disturbed");
  }

  std::vector<FoundTerm> Find(DiscoverOptions options = {}, int most_terms = 1) {
    options.most_terms = most_terms;
    return SearchTerms(replay, layout.Tolerances(), {}, options).terms;
  }
};

double Seconds(TimeNs t_ns, const Recording& recording) {
  return 1e-9 * static_cast<double>(t_ns - recording.wrist0->samples.front().t_ns);
}

TEST(DiscoverySearch, FindsAStepOfTheGages) {
  BaseReplay base(12.0, 21, [](Recording& recording) {
    for (auto& sample : recording.strain0->moments_Nm)
      if (Seconds(sample.t_ns, recording) > 7.3)
        sample.value += Eigen::Vector4d(0.01, 0.0, -0.006, 0.0);
  });
  const auto found = base.Find();
  ASSERT_EQ(found.size(), 1U);
  const Term& term = found[0].term;
  EXPECT_EQ(term.target, TermTarget::kStrain);
  EXPECT_EQ(FormOf(term), TermForm::kStep);
  EXPECT_EQ(term.variable, TermVariable::kTime);
  EXPECT_NEAR(term.at[0], 7.3, 0.03);
  EXPECT_NEAR(term.amplitude(0, 0), 0.01, 5e-4);
  EXPECT_NEAR(term.amplitude(2, 0), -0.006, 5e-4);
  EXPECT_LT(found[0].false_discovery, 0.005);
}

/// The gages and the EM position each jump by a little.
TEST(DiscoverySearch, TheFirstTermAloneMayBeSmall) {
  BaseReplay base(12.0, 23, [](Recording& recording) {
    for (auto& sample : recording.strain0->moments_Nm)
      if (Seconds(sample.t_ns, recording) > 7.3)
        sample.value += Eigen::Vector4d(0.0015, 0.0, -0.0009, 0.0);
    for (auto& sample : recording.em0->samples)
      if (Seconds(sample.t_ns, recording) > 4.1)
        sample.value.p_RS += Eigen::Vector3d(0.0, 0.00025, 0.0);
  });
  const LeastTerm any{.part = 0.0, .left = 0.0, .tolerances = 0.0};
  EXPECT_EQ(base.Find({}, 2).size(), 0U);
  EXPECT_EQ(base.Find({.least_first = any}, 2).size(), 1U);
  EXPECT_EQ(base.Find({.least = any}, 2).size(), 2U);
}

TEST(DiscoverySearch, FindsASwingOfTheEmOrientation) {
  BaseReplay base(12.0, 22, [](Recording& recording) {
    for (auto& sample : recording.em0->samples) {
      const double angle = 2.0 * std::numbers::pi * 2.37 * Seconds(sample.t_ns, recording);
      const Eigen::Vector3d w = 0.006 * std::sin(angle) * Eigen::Vector3d(0.1, 0.7, -0.7);
      sample.value.q_RS =
          Eigen::Quaterniond(Eigen::AngleAxisd(w.norm(), w.normalized())) * sample.value.q_RS;
    }
  });
  const auto found = base.Find();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].term.target, TermTarget::kEmOrientation);
  EXPECT_EQ(found[0].term.shape, TermShape::kPeriodic);
  EXPECT_NEAR(found[0].term.at[0], 2.37, 0.01);
}

/// What is there without doubt, and takes less than a twenty-fifth off the squares that are left.
TEST(DiscoverySearch, LeavesOutATermThatHardlyMatters) {
  BaseReplay base(12.0, 21, [](Recording& recording) {
    for (auto& sample : recording.strain0->moments_Nm)
      if (Seconds(sample.t_ns, recording) > 7.3)
        sample.value += Eigen::Vector4d(0.001, 0.0, -0.0006, 0.0);
  });
  const auto sure = base.Find({.least = {.part = 0.0, .left = 0.0, .tolerances = 0.0}});
  ASSERT_EQ(sure.size(), 1U);
  EXPECT_EQ(sure[0].term.target, TermTarget::kStrain);
  EXPECT_TRUE(base.Find({.least = {.part = 0.0, .tolerances = 0.0}}).empty());
}

TEST(DiscoverySearch, FindsNothingInNoise) {
  int found = 0;
  for (const std::uint64_t seed : {31, 32, 33, 34, 35, 36})
    found += !BaseReplay(6.0, seed, [](Recording&) {}).Find().empty();
  EXPECT_EQ(found, 0);
}

TEST(DiscoverySearch, SlowNoiseIsNoTerm) {
  int found = 0;
  for (const std::uint64_t seed : {41, 42, 43, 44}) {
    BaseReplay base(8.0, seed, [&](Recording& recording) {
      std::mt19937_64 rng(seed);
      std::normal_distribution<double> normal;
      Eigen::Vector4d slow = Eigen::Vector4d::Zero();
      constexpr double kKept = 0.98;  // a second at 50 Hz
      for (auto& sample : recording.strain0->moments_Nm) {
        for (double& s : slow) s = kKept * s + std::sqrt(1.0 - kKept * kKept) * normal(rng);
        sample.value += 0.002 * slow;
      }
    });
    found += !base.Find().empty();
  }
  EXPECT_EQ(found, 0);
}

/// Values of tables of Student's t.
TEST(DiscoverySearch, StudentsTail) {
  EXPECT_NEAR(StudentTail(2.262, 9.0), 0.025, 1e-3);
  EXPECT_NEAR(StudentTail(4.297, 9.0), 0.001, 1e-4);
  EXPECT_NEAR(StudentTail(6.869, 5.0), 0.0005, 1e-4);
  EXPECT_DOUBLE_EQ(StudentTail(-1.0, 5.0), 0.5);
}

/// A force that is found from the sample's own sensors shares their noise; one that hardly stands
/// out of the load cell's noise is made of that.
TEST(Library, HasForcesAsVariablesOnlyWhereTheLoadIsMeasuredAndNotNoise) {
  struct Case {
    bool has_load, is_noise;
  };
  for (const auto& [has_load, is_noise] :
       {Case{true, false}, Case{true, true}, Case{false, false}}) {
    SampleSet set;
    set.has_load = has_load;
    set.noise.force_N = is_noise ? 5.0 : 0.005;  // the forces below go from 0 to 39 N
    std::vector<TermState> states(40);
    for (std::size_t k = 0; k < states.size(); ++k) {
      states[k].t_s = 0.02 * double(k);
      states[k].scalar.fill(double(k));
    }
    int of_forces = 0;
    for (const Term& term : Library(TermTarget::kShaftLoad, states, set))
      of_forces +=
          term.variable == TermVariable::kLoad || term.variable == TermVariable::kPortForce;
    EXPECT_EQ(of_forces > 0, has_load && !is_noise);
    // Friction times a port's force that is noise is that noise.
    EXPECT_EQ(Library(TermTarget::kFriction, states, set).empty(), has_load && is_noise);
  }
}

}  // namespace
}  // namespace flextip::diagnosis
