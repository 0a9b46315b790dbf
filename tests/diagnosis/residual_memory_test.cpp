// The memory of residuals against series whose memory is known.
#include "diagnosis/evidence/residual_memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

/// AR(1) noise of variance `variance` and coefficient `phi`.
std::vector<double> Remembering(std::size_t n, double phi, double variance, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<double> series{std::sqrt(variance) * normal(rng)};
  while (series.size() < n)
    series.push_back(phi * series.back() + std::sqrt(variance * (1.0 - phi * phi)) * normal(rng));
  return series;
}

/// The variance of the mean of `n` samples times `n`, over many draws: what "so many samples as
/// one" means for noise whose variance was taken as 1.
double VarianceOfMean(double phi, double variance) {
  constexpr std::size_t kLength = 400;
  double squares = 0.0;
  for (unsigned draw = 0; draw < 2000; ++draw) {
    double sum = 0.0;
    for (const double value : Remembering(kLength, phi, variance, 5000 + draw)) sum += value;
    squares += sum * sum / kLength;
  }
  return squares / 2000.0;
}

TEST(ResidualMemory, IsTheVarianceOfAMeanOfTheResiduals) {
  for (const auto& [phi, variance] : {std::pair{0.8, 1.0}, {0.5, 1.0}, {0.8, 2.0}, {0.3, 3.0}}) {
    const ResidualMemory memory = MemoryOfSeries(Remembering(12000, phi, variance, 1));
    EXPECT_NEAR(memory.correlation, phi, 0.03);
    const double drawn = VarianceOfMean(phi, variance);
    EXPECT_NEAR(memory.slow_variance / drawn, 1.0, 0.12) << phi << " " << variance;
  }
}

TEST(ResidualMemory, IsNoneInNoiseThatForgets) {
  int none = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const ResidualMemory memory = MemoryOfSeries(Remembering(500, 0.0, 1.0, seed));
    none += memory.slow_variance <= 1.0;
  }
  EXPECT_GE(none, 98);
}

// Noise whose memory was counted in its variance already: nothing is left to pay for.
TEST(ResidualMemory, IsNotCountedTwice) {
  constexpr double kPhi = 0.7;
  const ResidualMemory memory =
      MemoryOfSeries(Remembering(20000, kPhi, (1.0 - kPhi) / (1.0 + kPhi), 3));
  EXPECT_NEAR(memory.slow_variance, 1.0, 0.12);
}

TEST(ResidualMemory, IsNotToldByFewSamples) {
  EXPECT_EQ(MemoryOfSeries(Remembering(40, 0.9, 1.0, 1)).SamplesAsOne(), 1.0);
  EXPECT_EQ(MemoryOfSeries({}).SamplesAsOne(), 1.0);
  EXPECT_EQ(MemoryOfSeries(std::vector<double>(100, 0.0)).SamplesAsOne(), 1.0);
}

}  // namespace
}  // namespace flextip::diagnosis
