// How much noise an unknown force takes up, against draws of that noise; and that a known load
// takes up the same for all hypotheses.
#include "diagnosis/evidence/force_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

constexpr double kCompliance_m_N = 0.001;

/// Under a hundred samples, so that none is passed over; the wrist is exact, the tip's noise the
/// same on all axes.
SampleSet FewSamples() {
  SampleSet samples = SmallSamples(2.3, false, 61, {}, true);
  samples.samples.erase(samples.samples.begin(), samples.samples.begin() + 16);
  for (DiagnosisSample& sample : samples.samples) {
    sample.p_RW_noise_m = 0.0;
    sample.p_RE_covariance_m2 = Eigen::Vector3d::Constant(1e-7).asDiagonal();
  }
  return samples;
}

class ForceVolumeTest : public testing::Test {
 protected:
  ForceVolumeTest() : layout_(samples_, MakeCatalogue(samples_)), replay_(samples_, layout_) {
    replay_.Evaluate(Compliant(0.0));
    replay_.FixNoiseModel();
  }

  Eigen::VectorXd Compliant(double compliance_m_N) const {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout_.Size());
    theta[layout_.Blocks()[layout_.Find("tip_compliance")].first] = compliance_m_N;
    return theta;
  }
  WhitenedRows RowsAt(double compliance_m_N) {
    EXPECT_TRUE(replay_.EvaluateWithForces(Compliant(compliance_m_N)));
    return replay_.Whiten();
  }

  SampleSet samples_ = FewSamples();
  ParameterLayout layout_;
  Replay replay_;
};

TEST_F(ForceVolumeTest, ASamplesShareIsWhatItsNoiseLoses) {
  const WhitenedRows rows = RowsAt(kCompliance_m_N);
  double largest = 0.0;
  for (std::size_t k = 0; k < samples_.samples.size(); ++k) {
    // Noise of unit variance in each row becomes units times it.
    EXPECT_NEAR(rows.force_share[k], rows.Rows(k) - rows.units[k].squaredNorm(), 1e-6) << k;
    largest = std::max(largest, rows.force_share[k]);
  }
  EXPECT_GT(largest, 2.0);
  EXPECT_LE(largest, 3.0);
}

TEST_F(ForceVolumeTest, IsWhatDrawnNoiseLosesToAYieldingTip) {
  const WhitenedRows stiff = RowsAt(0.0), compliant = RowsAt(kCompliance_m_N);
  const double volume = ForceVolume(replay_, 1.0, 1.0);
  EXPECT_GT(volume, 10.0);
  std::mt19937_64 random(62);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 400;
  std::vector<double> lost(kDraws, 0.0);
  for (double& squares : lost) {
    for (std::size_t k = 0; k < samples_.samples.size(); ++k) {
      Eigen::VectorXd noise(stiff.Rows(k));
      for (double& n : noise) n = normal(random);
      squares +=
          (stiff.units[k] * noise).squaredNorm() - (compliant.units[k] * noise).squaredNorm();
    }
  }
  const double mean = std::accumulate(lost.begin(), lost.end(), 0.0) / kDraws;
  double variance = 0.0;
  for (const double squares : lost) variance += std::pow(squares - mean, 2) / kDraws;
  EXPECT_NEAR(volume, mean, 5.0 * std::sqrt(variance / kDraws));
}

// Of a long recording few samples are asked. A camera of half the wrist's rate is in half of them.
TEST(ForceVolumeOfALongRecording, CountsSensorsAsOftenAsTheyAreThere) {
  for (const double duration_s : {8.0, 10.0, 12.0}) {
    const SampleSet samples = SmallSamples(duration_s, false, 64);
    const ParameterLayout layout(samples, MakeCatalogue(samples));
    Replay replay(samples, layout);
    const auto taken_at = [&](double compliance_m_N) {
      Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
      theta[layout.Blocks()[layout.Find("tip_compliance")].first] = compliance_m_N;
      EXPECT_TRUE(replay.EvaluateWithForces(theta));
      const std::vector<double> shares = replay.Whiten().force_share;
      return std::accumulate(shares.begin(), shares.end(), 0.0);
    };
    const double rigid = taken_at(0.0), yielding = taken_at(3e-4);
    ASSERT_GT(yielding - rigid, 20.0);
    EXPECT_NEAR(ForceVolume(replay, 1.0, 1.0) / (yielding - rigid), 1.0, 0.1) << duration_s;
  }
}

/// The first parameter of an effect, of the catalogue or not.
int FirstOf(const ParameterLayout& layout, const std::string& name) {
  for (const auto& block : layout.Blocks())
    if (block.effect->Name() == name) return block.first;
  ADD_FAILURE() << name;
  return 0;
}

// What is known of the mean needs no room along the shaft.
TEST(ForcePrior, IsNarrowAlongTheShaftUnderAConstantLoad) {
  hidden::HiddenOptions options{.exact = true};
  options.with_load = false;
  options.scene = {
      .motion = hidden::MotionKind::kSines, .load = hidden::LoadKind::kHungMass, .duration_s = 3.0};
  const SampleSet samples = MakeSampleSet(hidden::MakeHidden(options, 62).recording, "small");
  ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  const auto share = [&](const Eigen::VectorXd& theta) {
    EXPECT_TRUE(replay.Evaluate(theta));
    replay.FixNoiseModel();
    Eigen::VectorXd yielding = theta;
    yielding[layout.Blocks()[layout.Find("tip_compliance")].first] = kCompliance_m_N;
    EXPECT_TRUE(replay.EvaluateWithForces(yielding));
    const std::vector<double> shares = replay.Whiten().force_share;
    return std::accumulate(shares.begin(), shares.end(), 0.0) / double(shares.size());
  };
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  const double unknown_mean = share(theta);
  Eigen::Vector3d mean_N = Eigen::Vector3d::Zero();
  for (const auto& f : replay.Forces()) mean_N += f / double(replay.Forces().size());
  const Instrument& shaft = samples.instrument;
  const double unit_N = shaft.bending_stiffness_Nm2 / std::pow(shaft.length_m, 2);
  theta.segment<3>(FirstOf(layout, "mean_load")) = mean_N / unit_N;
  const double known_mean = share(theta);
  // Two rows across the shaft are taken up in any case.
  EXPECT_LT(known_mean - 2.0, 0.5 * (unknown_mean - 2.0)) << unknown_mean << ' ' << known_mean;
}

// Data sheets say rather too much noise. What is more than they say is not noise.
TEST_F(ForceVolumeTest, IsOfTheNoiseThatIsThere) {
  ASSERT_TRUE(replay_.EvaluateWithForces(Compliant(kCompliance_m_N)));
  constexpr double kMany = 1e9;  // rows, beside which those taken up are few
  const double stated = ForceVolume(replay_, kMany, kMany);
  EXPECT_GT(stated, 10.0);
  EXPECT_NEAR(ForceVolume(replay_, 0.5 * kMany, kMany) / stated, 0.5, 1e-3);
  EXPECT_EQ(ForceVolume(replay_, 4.0 * kMany, kMany), stated);
}

TEST_F(ForceVolumeTest, IsNothingWithoutACompliance) {
  ASSERT_TRUE(replay_.Evaluate(Compliant(0.0)));
  EXPECT_EQ(ForceVolume(replay_, 1.0, 1.0), 0.0);
}

TEST(KnownLoad, TakesUpTheSameNoiseWhateverYields) {
  const SampleSet samples = SmallSamples(2.3, true, 63);
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  ASSERT_TRUE(replay.Evaluate(theta));
  theta[layout.Blocks()[layout.Find("tip_compliance")].first] = kCompliance_m_N;
  const auto change = [&] {  // of a unit error's size, from no compliance to some
    EXPECT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
    const WhitenedRows stiff = replay.Whiten();
    EXPECT_TRUE(replay.Evaluate(theta));
    const WhitenedRows compliant = replay.Whiten();
    double largest = 0.0;
    for (std::size_t k = 0; k < stiff.units.size(); ++k)
      if (stiff.Rows(k) > 0)
        largest = std::max(largest, (stiff.units[k] - compliant.units[k]).norm());
    EXPECT_EQ(ForceVolume(replay, 1.0, 1.0), 0.0);
    return largest;
  };
  EXPECT_GT(change(), 1e-3);
  replay.FixNoiseModel();
  EXPECT_EQ(change(), 0.0);
}

}  // namespace
}  // namespace flextip::diagnosis
