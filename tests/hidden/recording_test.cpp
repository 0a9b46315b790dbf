// Recordings with a hidden effect: what is in them, and what is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "estimation/shaft_estimator.h"
#include "pipeline/sensor_readings.h"
#include "recording/recording_reader.h"
#include "recording/text/text.h"
#include "testdata/hidden/recording.h"

namespace flextip::hidden {
namespace {

class HiddenFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::temp_directory_path() / (std::string("flextip_hidden_") + info->name());
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string AllText() const {
    std::ostringstream text;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      text << entry.path().string() << '\n';
      if (entry.is_regular_file()) text << std::ifstream(entry.path()).rdbuf() << '\n';
    }
    return text.str();
  }

  std::filesystem::path folder_;
};

bool Holds(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

TEST_F(HiddenFolder, HoldsNoLabelAndNoTruth) {
  HiddenOptions options{.effects = {"stiffness", "taper"}};
  options.scene.duration_s = 2.0;
  const HiddenRecording hidden = MakeHidden(options, 11);
  WriteHidden(folder_, hidden);
  const std::string text = AllText();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "truth0"));
  for (const auto& [effect, parameters] : hidden.label.parameters) {
    // The nominal length_m and bending_stiffness_Nm2 are there, as in any recording.
    const bool nominal = effect == "length" || effect == "stiffness";
    EXPECT_TRUE(nominal || !Holds(text, effect)) << effect;
    for (const auto& [parameter, values] : parameters) {
      const bool of_instrument = parameter == "mass_per_length_kg_m";
      EXPECT_TRUE(of_instrument || !Holds(text, parameter + ":")) << parameter;
      for (const double value : values) {
        if (value == 0.0 || value == 1.0) continue;
        EXPECT_FALSE(Holds(text, NumberText(value))) << effect << ' ' << parameter;
      }
    }
  }
  for (const char* word : {"taper", "seed", "tissue", "label", "sines"}) {
    EXPECT_FALSE(Holds(text, word)) << word;
  }
  WriteHidden(folder_ / "again", hidden, true);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "again" / "truth0" / "data.csv"));
}

TEST_F(HiddenFolder, ReadsBackWithoutComplaint) {
  HiddenOptions options;
  options.scene.duration_s = 3.0;
  const HiddenRecording hidden = MakeHidden(options, 12);
  WriteHidden(folder_, hidden);
  const ReadResult read = ReadRecording(folder_);
  EXPECT_THAT(read.warnings, testing::IsEmpty());
  EXPECT_EQ(read.recording.wrist0->samples.size(), 150u);
  EXPECT_EQ(read.recording.em0->samples.size(), 150u);
  EXPECT_EQ(read.recording.load0->f_tip_N.size(), 150u);
  EXPECT_EQ(read.recording.vision0->tips.size(), 75u);
  EXPECT_EQ(read.recording.cam0->calibration.T_RC.p, hidden.scene.camera.T_RC.p);
  EXPECT_THROW(WriteHidden(folder_, hidden), InputError);
}

std::vector<double> Numbers(const Recording& recording) {
  std::vector<double> numbers;
  const auto add = [&](const auto& v) {
    numbers.insert(numbers.end(), v.data(), v.data() + v.size());
  };
  for (const auto& s : recording.wrist0->samples) {
    add(s.value.p_RW);
    if (s.value.q_RW) add(s.value.q_RW->coeffs());
  }
  if (recording.em0) {
    for (const auto& s : recording.em0->samples) add(s.value.p_RS), add(s.value.q_RS.coeffs());
  }
  if (recording.strain0) {
    for (const auto& s : recording.strain0->moments_Nm) add(s.value);
  }
  if (recording.vision0) {
    for (const auto& s : recording.vision0->tips) add(s.value.p_RE), add(*s.value.d_RE);
  }
  return numbers;
}

TEST(HiddenRecordingTest, SameSeedSameRecording) {
  HiddenOptions options{.drawn_effects = 2};
  options.scene.duration_s = 2.0;
  const HiddenRecording a = MakeHidden(options, 21), b = MakeHidden(options, 21),
                        other = MakeHidden(options, 22);
  EXPECT_EQ(Numbers(a.recording), Numbers(b.recording));
  EXPECT_EQ(a.label.present, b.label.present);
  EXPECT_EQ(a.label.parameters, b.label.parameters);
  EXPECT_NE(Numbers(a.recording), Numbers(other.recording));
  EXPECT_EQ(a.label.present.size(), 2u);
}

TEST(HiddenRecordingTest, LeavingASensorOutChangesNoOther) {
  HiddenOptions options;
  options.scene.duration_s = 2.0;
  const HiddenRecording all = MakeHidden(options, 23);
  options.left_out = {"em0", "vision0"};
  options.with_load = false;
  const HiddenRecording some = MakeHidden(options, 23);
  EXPECT_FALSE(some.recording.em0 || some.recording.vision0 || some.recording.load0 ||
               some.recording.cam0);
  EXPECT_EQ(all.recording.strain0->moments_Nm, some.recording.strain0->moments_Nm);
  EXPECT_EQ(all.recording.wrist0->samples[40].value.p_RW,
            some.recording.wrist0->samples[40].value.p_RW);
  options.left_out = {"wrist0_orientation"};
  EXPECT_FALSE(MakeHidden(options, 23).recording.wrist0->samples[0].value.q_RW);
  options.left_out = {"em7"};
  EXPECT_THROW(MakeHidden(options, 23), InputError);
}

/// Differences of all samples in units of their noise: the root of the sum of their squares.
double Distance(const Recording& a, const Recording& b) {
  double sum = 0.0;
  const auto square = [](double x) { return x * x; };
  // A stamp that is off by the time in which the sensor moves so many deviations.
  const auto stamps = [&](TimeNs one, TimeNs two, const Eigen::Vector3d& way, double noise_m,
                          double rate_hz) {
    return square(1e-9 * static_cast<double>(one - two) * rate_hz * way.norm() / noise_m);
  };
  for (std::size_t i = 1; i < a.em0->samples.size(); ++i) {
    sum += stamps(a.em0->samples[i].t_ns, b.em0->samples[i].t_ns,
                  a.em0->samples[i].value.p_RS - a.em0->samples[i - 1].value.p_RS,
                  a.em0->position_noise_m, a.em0->rate_hz);
  }
  for (std::size_t i = 1; i < a.vision0->tips.size(); ++i) {
    const auto &tip = a.vision0->tips[i], &last = a.vision0->tips[i - 1];
    sum += stamps(tip.t_ns, b.vision0->tips[i].t_ns, tip.value.p_RE - last.value.p_RE,
                  std::sqrt(tip.value.covariance_m2.trace() / 3.0), a.vision0->rate_hz);
  }
  for (std::size_t i = 0; i < a.load0->f_tip_N.size(); ++i) {
    sum += ((a.load0->f_tip_N[i].value - b.load0->f_tip_N[i].value) / a.load0->force_noise_N)
               .squaredNorm();
  }
  for (std::size_t i = 0; i < a.wrist0->samples.size(); ++i) {
    const EmSample &p = a.em0->samples[i].value, &q = b.em0->samples[i].value;
    sum +=
        square(a.wrist0->samples[i].value.q_RW->angularDistance(*b.wrist0->samples[i].value.q_RW) /
               a.wrist0->orientation_noise_rad);
    sum += ((p.p_RS - q.p_RS) / a.em0->position_noise_m).squaredNorm();
    sum += square(p.q_RS.angularDistance(q.q_RS) / a.em0->orientation_noise_rad);
    sum += ((a.strain0->moments_Nm[i].value - b.strain0->moments_Nm[i].value) /
            a.strain0->moment_noise_Nm)
               .squaredNorm();
  }
  for (std::size_t i = 0; i < a.vision0->tips.size(); ++i) {
    const TipObservation &p = a.vision0->tips[i].value, &q = b.vision0->tips[i].value;
    sum += (p.p_RE - q.p_RE).dot(Ldlt(p.covariance_m2).Solve(p.p_RE - q.p_RE));
    sum += ((*p.d_RE - *q.d_RE) / a.vision0->direction_noise_rad).squaredNorm();
  }
  return std::sqrt(sum);
}

class EveryEffect : public testing::TestWithParam<std::string> {};

TEST_P(EveryEffect, StandsOutFromTheNoise) {
  // Plain effects under two kinds of load, 8 s. A test that knew what to look for would see
  // `distance` standard deviations. Friction is the faintest: it moves a pinned shaft only through
  // the axial force.
  for (const std::uint64_t seed : {31u, 32u, 33u}) {
    HiddenOptions options{.exact = true, .noise_free = true};
    // Clocks run apart slowly.
    options.scene.duration_s = GetParam().ends_with("_clock") ? 25.0 : 8.0;
    options.scene.load = seed == 32 ? LoadKind::kTissue : LoadKind::kVarying;
    options.scene.family = MotionFamily::kAny;
    const HiddenRecording healthy = MakeHidden(options, seed);
    options.effects = {GetParam()};
    const HiddenRecording sick = MakeHidden(options, seed);
    const double distance = Distance(healthy.recording, sick.recording);
    std::printf("%-18s %7.1f\n", GetParam().c_str(), distance);
    EXPECT_GT(distance, 5.0) << GetParam();
  }
}

std::vector<std::string> AllForms() {
  std::vector<std::string> names = simulation::CatalogueEffects();
  names.insert(names.end(), OtherForms().begin(), OtherForms().end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Hidden, EveryEffect, testing::ValuesIn(AllForms()),
                         [](const auto& effect) { return effect.param; });

/// As flextip estimate does it, with the port known.
double Chi2PerFreedom(const Recording& recording) {
  EstimatorOptions options;
  options.instrument = recording.instrument;
  options.p_RP = recording.p_RP;
  options.gravity_m_s2 = recording.gravity_m_s2;
  options.port_prior_m = 1e-7;
  options.estimate_tissue = false;
  ShaftEstimator estimator(options);
  double chi2 = 0.0;
  int freedom = 0;
  for (const TimeNs t_ns : EstimationTimes(recording)) {
    const ShaftEstimate estimate = estimator.Update(*MeasurementsAt(recording, t_ns));
    EXPECT_EQ(estimate.status, EstimateStatus::kOk);
    chi2 += estimate.chi2;
    // The tip force is fitted. The wrist is too, but it is not counted as measured.
    freedom += estimate.measurements - 3;
  }
  return chi2 / freedom;
}

TEST(HiddenRecordingTest, HealthyExactOnesReplayToTheirNoise) {
  for (const std::uint64_t seed : {41u, 42u, 43u, 44u}) {
    HiddenOptions options{.exact = true};
    options.scene.duration_s = 6.0;
    options.scene.family = MotionFamily::kAny;
    const HiddenRecording hidden = MakeHidden(options, seed);
    const double ratio = Chi2PerFreedom(hidden.recording);
    std::printf("seed %d: chi2 per degree of freedom %.4f\n", int(seed), ratio);
    EXPECT_NEAR(ratio, 1.0, 0.06) << seed;
  }
}

TEST(HiddenRecordingTest, CoarseChainIsFineEnough) {
  for (const std::uint64_t seed : {51u, 52u, 53u, 54u, 55u, 56u}) {
    HiddenOptions options{.exact = true, .noise_free = true};
    options.scene.duration_s = 4.0;
    const HiddenRecording coarse = MakeHidden(options, seed);
    options.links_per_side = 240;
    const HiddenRecording fine = MakeHidden(options, seed);
    double worst = 0.0;
    for (std::size_t i = 0; i < coarse.truth.size(); ++i) {
      worst = std::max(worst, (coarse.truth[i].value.p_RE - fine.truth[i].value.p_RE).norm());
    }
    std::printf("seed %d: 60 links a side, tip within %.1f um\n", int(seed), 1e6 * worst);
    EXPECT_LT(worst, 20e-6) << seed;
  }
}

}  // namespace
}  // namespace flextip::hidden
