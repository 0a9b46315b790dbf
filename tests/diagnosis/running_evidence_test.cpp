// The sums and the evidence of the running diagnosis against dense covariances.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "diagnosis/running/onset_evidence.h"

namespace flextip::diagnosis::running {
namespace {

std::vector<WatchedRows> DrawSamples(int count, int seed) {
  std::mt19937_64 rng(static_cast<std::uint64_t>(seed));
  std::normal_distribution<double> normal;
  std::vector<WatchedRows> samples(static_cast<std::size_t>(count));
  for (WatchedRows& rows : samples) {
    for (double& x : rows.e) x = normal(rng);
    for (double& x : rows.X.reshaped()) x = 0.1 * normal(rng);
  }
  return samples;
}

/// Minus twice the logarithm of the density of all rows, which `spread` times standard normal
/// numbers and unit noise make.
double Misfit(const Eigen::VectorXd& e, const Eigen::MatrixXd& spread) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Identity(e.size(), e.size());
  C += spread * spread.transpose();
  const Eigen::LDLT<Eigen::MatrixXd> factor(C);
  return e.dot(factor.solve(e)) + factor.vectorD().array().log().sum();
}

/// Two blocks of samples; a cause sets in with the second.
struct TwoBlocks {
  static constexpr int kOfBlock = 4;
  std::vector<WatchedRows> samples = DrawSamples(2 * kOfBlock, 7);
  Information blocks[2];

  TwoBlocks() {
    for (int i = 0; i < 2 * kOfBlock; ++i)
      blocks[i / kOfBlock].Add(samples[static_cast<std::size_t>(i)]);
  }

  Eigen::VectorXd Residual() const {
    Eigen::VectorXd e(kRows * static_cast<Eigen::Index>(samples.size()));
    for (std::size_t k = 0; k < samples.size(); ++k)
      e.segment<kRows>(kRows * static_cast<Eigen::Index>(k)) = samples[k].e;
    return e;
  }
  /// Columns: the parameters, and the first ones of `block` in the second block, with the typical
  /// deviations times `size`.
  Eigen::MatrixXd Spread(const WatchedBlock& block, double size) const {
    const int extra = block.widened;
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(Residual().size(), kParameters + extra);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Eigen::Index row = kRows * static_cast<Eigen::Index>(k);
      const bool late = k >= kOfBlock;
      X.block<kRows, kParameters>(row, 0) = samples[k].X;
      // A drift grows by a half in its first block, and by one in each more.
      const double grown = block.drifts ? (late ? 1.5 : 0.5) : (late ? 1.0 : 0.0);
      for (int i = 0; i < extra; ++i)
        X.col(kParameters + i).segment<kRows>(row) = grown * size *
                                                     block.typical[static_cast<std::size_t>(i)] *
                                                     samples[k].X.col(block.first + i);
    }
    return X;
  }
};

Recording Base() {
  Recording base;
  base.instrument = {0.6, 0.00238, 0.304, 0.0351};
  base.p_RP = {0.0, 0.0, 0.17};
  return base;
}

/// Both blocks, weighed by the watched parameters.
class OnsetEvidenceTest : public testing::Test {
 protected:
  OnsetEvidenceTest() {
    all.Add(two.blocks[1]);
    weighing.Take(all);
  }

  const TwoBlocks two;
  const Eigen::VectorXd e = two.Residual();
  const SampleWatch watch{Base()};
  const WatchedParameters parameters{watch.Set(), 0.0};
  Information all = two.blocks[0];
  AllSamples weighing;
};

TEST_F(OnsetEvidenceTest, IsTheRatioOfTwoDensities) {
  weighing.Since(two.blocks[1]);
  int compared = 0;
  for (const WatchedBlock& block : parameters.Blocks()) {
    if (block.widened == 0 || block.positive || block.drifts) continue;
    Eigen::MatrixXd none = two.Spread(block, 0.0);
    double expected = 0.0;
    for (const double size : {0.3, 1.0, 3.0})
      expected += std::exp(0.5 * (Misfit(e, none) - Misfit(e, two.Spread(block, size)))) / 3.0;
    EXPECT_NEAR(weighing.Of(block, parameters).log_ratio, std::log(expected), 1e-6)
        << block.effect->Name();
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST_F(OnsetEvidenceTest, OfADriftIsTheRatioOfTwoDensities) {
  weighing.Since(all);
  int compared = 0;
  for (const WatchedBlock& block : parameters.Blocks()) {
    if (!block.drifts) continue;
    Growth growth;
    growth.TakeOlder({}, two.blocks[1], block.first);
    growth.TakeOlder(two.blocks[1], two.blocks[0], block.first);
    const double none = Misfit(e, two.Spread(block, 0.0));
    double expected = 0.0;
    for (const double size : {0.3, 1.0, 3.0})
      expected += std::exp(0.5 * (none - Misfit(e, two.Spread(block, size)))) / 3.0;
    EXPECT_NEAR(weighing.Of(block, parameters, growth).log_ratio, std::log(expected), 1e-6);
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

TEST_F(OnsetEvidenceTest, OfAllCausesAtOnceIsTheRatioOfTwoDensities) {
  weighing.Since(two.blocks[1]);
  Eigen::MatrixXd spread(e.size(), 0);
  for (const WatchedBlock& block : parameters.Blocks()) {
    if (block.widened == 0 || block.drifts) continue;
    const Eigen::MatrixXd of_block = two.Spread(block, 1.0).rightCols(block.widened);
    spread.conservativeResize(Eigen::NoChange, spread.cols() + of_block.cols());
    spread.rightCols(of_block.cols()) = of_block;
  }
  const Eigen::MatrixXd within = two.Spread(parameters.Blocks()[0], 0.0);
  Eigen::MatrixXd both(e.size(), within.cols() + spread.cols());
  both << within, spread;
  EXPECT_NEAR(weighing.OfAll(parameters), 0.5 * (Misfit(e, within) - Misfit(e, both)), 1e-6);
}

TEST_F(OnsetEvidenceTest, OfWhatCannotBeNegativeIsOneSided) {
  Information turned = two.blocks[1];
  turned.g *= -1.0;
  for (const WatchedBlock& block : parameters.Blocks()) {
    if (block.widened != 1 || !block.positive) continue;
    // Once as drawn and once with the signs turned: both halves together are the whole normal.
    weighing.Take(all);
    weighing.Since(two.blocks[1]);
    const double one = weighing.Of(block, parameters).log_ratio;
    Information all_turned = all;
    all_turned.g *= -1.0;
    weighing.Take(all_turned);
    weighing.Since(turned);
    const double other = weighing.Of(block, parameters).log_ratio;
    double whole = 0.0;
    for (const double size : {0.3, 1.0, 3.0})
      whole +=
          std::exp(0.5 * (Misfit(e, two.Spread(block, 0.0)) - Misfit(e, two.Spread(block, size)))) /
          3.0;
    EXPECT_NEAR(0.5 * (std::exp(one) + std::exp(other)), whole, 1e-6 * whole)
        << block.effect->Name();
  }
}

TEST(AddLogarithms, AddsWhatTheyAreOf) {
  EXPECT_NEAR(AddLogarithms(std::log(3.0), std::log(5.0)), std::log(8.0), 1e-12);
  const double none = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(AddLogarithms(none, 2.0), 2.0);
  EXPECT_EQ(AddLogarithms(none, none), none);
  EXPECT_NEAR(AddLogarithms(2000.0, 1.0), 2000.0, 1e-9);
}

}  // namespace
}  // namespace flextip::diagnosis::running
