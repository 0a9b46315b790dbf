// All hypotheses and how likely each is: evidence and prior odds.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/evidence/evidence.h"
#include "diagnosis/evidence/linear_problem.h"

namespace flextip::diagnosis {

struct SelectionOptions {
  int blocks = 20;                  ///< of time, for bagging and held-out parts
  double discrepancy = 0.06;        ///< what a right form may miss of its effect's signal, relative
  double first_discrepancy = 0.15;  ///< while linearised far from the answer
  double least_discrepancy = 0.1;   ///< of the noise
  double prior_none = 0.5, prior_singles = 0.33, prior_pairs = 0.08, prior_unknown = 0.05;
  /// Of all three effects together; of one more a quarter of that, and so on.
  double prior_triples = 0.02;
};

struct ScoredHypothesis {
  WeighedHypothesis weighed;
  double log_posterior = 0.0;  ///< evidence and prior odds, not normalised
};

/// What a hypothesis's own fit says of its log posterior, less what the linear problem says.
struct Correction {
  Hypothesis hypothesis;
  double log = 0.0;
};

/// log of the prior odds of a hypothesis among `effects` ones of the catalogue.
double LogPrior(const Hypothesis& h, int effects, const SelectionOptions& options);

/// None, every single effect, every two, and so on up to `most` at once.
std::vector<Hypothesis> KnownHypotheses(int effects, std::size_t most);

/// None, singles and pairs, and something unknown by itself or beside each single effect.
std::vector<Hypothesis> AllHypotheses(int effects);

/// `hypotheses` among `effects` ones of the catalogue, weighed, best first.
std::vector<ScoredHypothesis> Score(const Evidence& evidence, int effects,
                                    const std::vector<Hypothesis>& hypotheses,
                                    const SelectionOptions& options,
                                    const std::vector<Correction>& corrections = {});

/// `scored` of the same evidence, and three and four effects at once: as long as the best of so
/// many effects is likelier than the best with one fewer, the leaders among them get one more. All
/// of these could not be weighed, and a cause that shows in three shows in two.
std::vector<ScoredHypothesis> Grown(const Evidence& evidence, int effects,
                                    std::vector<ScoredHypothesis> scored,
                                    const SelectionOptions& options,
                                    const std::vector<Correction>& corrections = {});

}  // namespace flextip::diagnosis
