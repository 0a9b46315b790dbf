// From recordings to the diagnosis's samples: what is refused, left out, thinned and dropped.
#include "diagnosis/samples/sample_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/error.h"
#include "testdata/hidden/recording.h"

namespace flextip::diagnosis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// 3 s at 50 Hz, the tip at 25 Hz.
Recording MakeRecording() {
  hidden::HiddenOptions options{.exact = true};
  options.scene.duration_s = 3.0;
  options.scene.load = hidden::LoadKind::kVarying;
  return hidden::MakeHidden(options, 21).recording;
}

std::string RefusalOf(const Recording& recording) {
  try {
    MakeSampleSet(recording, "folder");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class SampleSetTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { healthy_ = new Recording(MakeRecording()); }
  static void TearDownTestSuite() { delete healthy_; }
  void ExpectRefused(const std::string& part) const {
    const std::string line = RefusalOf(recording_);
    EXPECT_THAT(line, StartsWith("folder: "));
    EXPECT_THAT(line, HasSubstr(part));
    EXPECT_THAT(line, Not(HasSubstr("\n")));
  }

  static Recording* healthy_;
  Recording recording_ = *healthy_;
};
Recording* SampleSetTest::healthy_ = nullptr;

TEST_F(SampleSetTest, TakesTheMeasuredValuesAsTheyAre) {
  const SampleSet set = MakeSampleSet(recording_, "folder");
  ASSERT_EQ(set.samples.size(), recording_.wrist0->samples.size());
  EXPECT_THAT(set.warnings, IsEmpty());
  EXPECT_TRUE(set.has_em && set.has_strain && set.has_tip && set.has_tip_direction);
  EXPECT_TRUE(set.has_load && set.has_wrist_direction && set.has_camera && set.resolved_in_time);
  EXPECT_NEAR(set.period_s, 0.02, 1e-9);
  int seen = 0;
  for (std::size_t k = 0; k < set.samples.size(); ++k) {
    const DiagnosisSample& sample = set.samples[k];
    const TimeNs t_ns = recording_.wrist0->samples[k].t_ns;
    EXPECT_NEAR(sample.t_s, double(t_ns - recording_.wrist0->samples[0].t_ns) * 1e-9, 1e-12);
    const auto strain = std::ranges::find_if(recording_.strain0->moments_Nm,
                                             [&](const auto& s) { return s.t_ns == t_ns; });
    ASSERT_NE(strain, recording_.strain0->moments_Nm.end());
    EXPECT_EQ(sample.moments_Nm, strain->value);
    if (!sample.Has(row::kTipPosition)) continue;
    ++seen;
    const auto tip = std::ranges::find_if(recording_.vision0->tips,
                                          [&](const auto& s) { return s.t_ns == t_ns; });
    ASSERT_NE(tip, recording_.vision0->tips.end());
    EXPECT_EQ(sample.p_RE, tip->value.p_RE);
  }
  EXPECT_GT(seen, 60);  // every second sample, less the end
  EXPECT_LT(seen, 80);
}

TEST_F(SampleSetTest, RefusesWithoutAWrist) {
  recording_.wrist0.reset();
  ExpectRefused("no wrist0");
}

TEST_F(SampleSetTest, RefusesWhatIsTooShort) {
  recording_.wrist0->samples.resize(39);
  ExpectRefused("39 samples of the wrist, at least 40");
  recording_.wrist0->samples.clear();
  ExpectRefused("0 samples of the wrist");
}

TEST_F(SampleSetTest, RefusesWithoutRedundancy) {
  recording_.em0.reset();
  recording_.vision0.reset();
  recording_.load0.reset();
  recording_.strain0.reset();
  ExpectRefused("nothing to judge the simulation by");
}

TEST_F(SampleSetTest, SaysThatSensorsStateNoNoise) {
  recording_.load0.reset();
  recording_.vision0.reset();
  for (auto& sample : recording_.wrist0->samples) sample.value.q_RW.reset();
  recording_.em0->position_noise_m = recording_.em0->orientation_noise_rad = 0.0;
  recording_.strain0->moment_noise_Nm = 0.0;
  ExpectRefused("em0 states no noise of its places: left out; strain0 states no noise: left out");
}

TEST_F(SampleSetTest, AKnownLoadMakesOneSensorEnough) {
  recording_.em0.reset();
  recording_.vision0.reset();
  recording_.strain0.reset();
  EXPECT_EQ(RefusalOf(recording_), "");
}

TEST_F(SampleSetTest, LeavesDeadSensorsOutWithAWarning) {
  for (auto& sample : recording_.em0->samples)
    sample.value.p_RS = recording_.em0->samples[0].value.p_RS;
  for (auto& tip : recording_.vision0->tips)
    tip.value.p_RE = recording_.vision0->tips[0].value.p_RE;
  for (auto& sample : recording_.strain0->moments_Nm) sample.value[2] = 0.1;
  const SampleSet set = MakeSampleSet(recording_, "folder");
  EXPECT_THAT(set.warnings, ElementsAre("em0 always says the same: left out",
                                        "strain0: 1 of 4 gages always say the same: left out",
                                        "vision0 always says the same: left out"));
  EXPECT_FALSE(set.has_em || set.has_tip);
  EXPECT_TRUE(set.has_strain);
  for (const DiagnosisSample& sample : set.samples) {
    EXPECT_FALSE(sample.Has(row::kEmPosition) || sample.Has(row::kTipPosition));
    EXPECT_FALSE(sample.Has(row::kStrain + 2));
    EXPECT_TRUE(sample.spoken[row::kStrain] && sample.spoken[row::kStrain + 3]);
    EXPECT_FALSE(sample.spoken[row::kStrain + 2]);
  }
}

TEST_F(SampleSetTest, SaysWhichGageIsAtItsLimit) {
  auto& moments_Nm = recording_.strain0->moments_Nm;
  const auto [low, high] = std::ranges::minmax_element(
      moments_Nm, [](const auto& a, const auto& b) { return a.value[2] < b.value[2]; });
  const double limit = 0.5 * (low->value[2] + high->value[2]);
  for (auto& sample : moments_Nm) sample.value[2] = std::min(sample.value[2], limit);
  const SampleSet set = MakeSampleSet(recording_, "folder");
  EXPECT_THAT(set.warnings, ElementsAre(StartsWith("strain0: m2_y is at its limit in ")));
  for (const DiagnosisSample& sample : set.samples) EXPECT_TRUE(sample.spoken[row::kStrain + 2]);
}

TEST_F(SampleSetTest, LeavesStrainOutWhereItsAxesAreUnknown) {
  for (auto& sample : recording_.wrist0->samples) sample.value.q_RW.reset();
  const SampleSet set = MakeSampleSet(recording_, "folder");
  EXPECT_FALSE(set.has_strain);
  EXPECT_TRUE(set.has_em && set.has_tip);
  EXPECT_THAT(set.warnings, ElementsAre(StartsWith("strain0 is about the wrist's axes")));
}

TEST_F(SampleSetTest, LeavesOutALoadThatCoversLessThanHalf) {
  recording_.load0->f_tip_N.resize(recording_.load0->f_tip_N.size() / 3);
  const SampleSet set = MakeSampleSet(recording_, "folder");
  EXPECT_FALSE(set.has_load);
  EXPECT_THAT(set.warnings, ElementsAre(HasSubstr("load0")));
}

// A load cell's noise bends the predicted shaft. Where no other sample said what noise is, a
// shorter or stiffer shaft looked better: a healthy recording of 1.6 s was `stiffness`.
TEST_F(SampleSetTest, NearTheEndsALoadAtRestIsThatOfSamplesWithOtherNoise) {
  constexpr double kNoise_N = 0.01;
  const Eigen::Vector3d rest_N(0.2, -0.1, 0.3);
  std::mt19937_64 rng(4);
  std::normal_distribution<double> normal(0.0, kNoise_N);
  recording_.load0->force_noise_N = kNoise_N;
  for (auto& f_N : recording_.load0->f_tip_N) {
    f_N.value = rest_N;
    for (double& part_N : f_N.value) part_N += normal(rng);
  }
  const SampleSet set = MakeSampleSet(recording_, "folder");
  double own2 = 0.0, around2 = 0.0, together = 0.0;
  const std::size_t n = set.samples.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (k >= 21 && k + 21 < n) continue;
    const Eigen::Vector3d own = set.samples[k].f_tip_N - rest_N;
    const Eigen::Vector3d around = set.samples[k].f_around_N - rest_N;
    own2 += own.squaredNorm();
    around2 += around.squaredNorm();
    together += own.dot(around);
  }
  EXPECT_LT(around2, 0.5 * own2);
  EXPECT_LT(std::abs(together), 0.4 * std::sqrt(own2 * around2));
}

TEST_F(SampleSetTest, NearTheEndsALoadThatMovesIsAsRead) {
  auto& f_N = recording_.load0->f_tip_N;
  for (std::size_t i = 0; i < f_N.size(); ++i)
    f_N[i].value = {0.0, 0.0, 2.0 * double(i) / double(f_N.size())};
  const SampleSet set = MakeSampleSet(recording_, "folder");
  for (const DiagnosisSample& sample : {set.samples.front(), set.samples[10], set.samples.back()})
    EXPECT_EQ(sample.f_around_N, sample.f_tip_N);
}

TEST_F(SampleSetTest, ThinsAFastWrist) {
  Series<WristSample> fast;  // 500 Hz
  const auto slow = recording_.wrist0->samples;
  for (std::size_t k = 0; k + 1 < slow.size(); ++k) {
    for (int i = 0; i < 10; ++i) {
      const double u = 0.1 * i;
      fast.push_back({slow[k].t_ns + TimeNs(u * double(slow[k + 1].t_ns - slow[k].t_ns)),
                      {Interpolate(slow[k].value.p_RW, slow[k + 1].value.p_RW, u),
                       Interpolate(*slow[k].value.q_RW, *slow[k + 1].value.q_RW, u)}});
    }
  }
  recording_.wrist0->samples = fast;
  const SampleSet set = MakeSampleSet(recording_, "folder");
  EXPECT_NEAR(set.period_s, 0.02, 1e-6);
  EXPECT_EQ(set.samples.size(), slow.size() - 1);
}

TEST_F(SampleSetTest, DropsTheStartAndWhatLateSensorsSayOfTheEnd) {
  const SampleSet set = MakeSampleSet(recording_, "folder");
  const double last_s = set.samples.back().t_s;
  for (const DiagnosisSample& sample : set.samples) {
    EXPECT_TRUE(sample.spoken[row::kWristDirection] && sample.spoken[row::kStrain]);
    if (sample.t_s < 0.301) {
      EXPECT_TRUE(sample.present.none() || sample.t_s > 0.299) << sample.t_s;
      continue;
    }
    EXPECT_TRUE(sample.Has(row::kWristDirection) && sample.Has(row::kStrain));
    const bool at_end = sample.t_s > last_s - 0.249;
    if (at_end) {
      EXPECT_FALSE(sample.Has(row::kEmPosition) || sample.Has(row::kEmDirection) ||
                   sample.Has(row::kTipPosition) || sample.Has(row::kTipDirection));
    } else if (sample.t_s < last_s - 0.251) {
      EXPECT_TRUE(sample.Has(row::kEmPosition) && sample.Has(row::kEmDirection)) << sample.t_s;
    }
  }
}

}  // namespace
}  // namespace flextip::diagnosis
