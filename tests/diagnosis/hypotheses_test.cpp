// Which hypotheses are weighed, on random linear problems: what grows from pairs against every
// subset of the effects.
#include "diagnosis/search/hypotheses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

constexpr int kEffects = 9, kRows = 120;

/// Nine effects of one to three parameters, of which those of `present` act.
struct RandomProblem {
  Priors priors;
  NormalSums sums;

  RandomProblem(const std::vector<int>& present, std::uint64_t seed) : sums(0) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> normal;
    for (int e = 0; e < kEffects; ++e)
      priors.Append(std::vector<FitParameter>(1 + e % 3, {.tolerance = 0.02, .typical = 1.0}));
    Eigen::MatrixXd X(kRows, priors.Size());
    for (Eigen::Index i = 0; i < X.size(); ++i) X.data()[i] = normal(rng);
    Eigen::VectorXd z(kRows);
    for (double& value : z) value = normal(rng);
    for (const int e : present)
      for (int j = 0; j < priors.Span(e).size; ++j) z += 0.9 * X.col(priors.Span(e).first + j);
    sums = NormalSums(priors.Size());
    sums.H = X.transpose() * X;
    sums.g = X.transpose() * z;
    sums.c = z.squaredNorm();
    sums.rows = kRows;
  }
};

std::vector<ScoredHypothesis> PairsGrown(const RandomProblem& problem) {
  const Evidence evidence(problem.sums, problem.priors, {}, {.unknown_sd = {}});
  const SelectionOptions options;
  return Grown(evidence, kEffects, Score(evidence, kEffects, KnownHypotheses(kEffects, 2), options),
               options);
}

TEST(Hypotheses, AreAllSubsetsUpToTheMost) {
  for (const std::size_t most : {0U, 1U, 2U, 3U, 9U}) {
    const auto known = KnownHypotheses(kEffects, most);
    std::size_t subsets = 0;
    for (unsigned bits = 0; bits < (1U << kEffects); ++bits)
      subsets += std::size_t(__builtin_popcount(bits)) <= most ? 1 : 0;
    EXPECT_EQ(known.size(), subsets);
    for (std::size_t i = 1; i < known.size(); ++i)
      EXPECT_GE(known[i].effects.size(), known[i - 1].effects.size());
  }
}

TEST(Hypotheses, PriorsOfEachSizeAddUpToTheOptions) {
  const SelectionOptions options;
  std::vector<double> sums(5, 0.0);
  for (const Hypothesis& h : KnownHypotheses(kEffects, 4))
    sums[h.effects.size()] += std::exp(LogPrior(h, kEffects, options));
  EXPECT_NEAR(sums[0], options.prior_none, 1e-12);
  EXPECT_NEAR(sums[1], options.prior_singles, 1e-12);
  EXPECT_NEAR(sums[2], options.prior_pairs, 1e-12);
  EXPECT_NEAR(sums[3], options.prior_triples, 1e-12);
  EXPECT_NEAR(sums[4], 0.25 * options.prior_triples, 1e-12);
}

TEST(Hypotheses, GrowToTheBestOfAllSubsets) {
  const SelectionOptions options;
  const std::vector<std::vector<int>> cases{{}, {4}, {1, 7}, {0, 3, 5}, {2, 6, 8}, {0, 2, 5, 7}};
  for (const auto& present : cases) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const RandomProblem problem(present, seed);
      const Evidence evidence(problem.sums, problem.priors, {}, {.unknown_sd = {}});
      const auto all = Score(evidence, kEffects, KnownHypotheses(kEffects, 4), options);
      const auto grown = PairsGrown(problem);
      EXPECT_EQ(grown.front().weighed.hypothesis, all.front().weighed.hypothesis) << seed;
      EXPECT_NEAR(grown.front().log_posterior, all.front().log_posterior, 1e-9);
      EXPECT_TRUE(std::ranges::includes(grown.front().weighed.hypothesis.effects, present)) << seed;
    }
  }
}

TEST(Hypotheses, OfASingleEffectDoNotGrow) {
  const RandomProblem problem({4}, 1);
  EXPECT_EQ(PairsGrown(problem).size(), KnownHypotheses(kEffects, 2).size());
}

TEST(Hypotheses, AreGrownOnceEach) {
  const auto grown = PairsGrown(RandomProblem({0, 3, 5}, 2));
  for (std::size_t i = 0; i < grown.size(); ++i)
    for (std::size_t j = i + 1; j < grown.size(); ++j)
      EXPECT_FALSE(grown[i].weighed.hypothesis == grown[j].weighed.hypothesis);
}

}  // namespace
}  // namespace flextip::diagnosis
