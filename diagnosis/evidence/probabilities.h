// From evidence to probabilities that mean what they say.
#pragma once

#include <map>
#include <random>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

struct ProbabilityOptions {
  int bags = 8;              ///< resamplings of the blocks of time
  int leaders = 30;          ///< known hypotheses that take part in them, and unknown ones
  double temperature = 1.0;  ///< log odds are divided by this; from recordings made for tuning
  double credible = 0.9;
  /// Chi-squared per degree of freedom of the best that the catalogue has, above which none of it
  /// is adequate: all of it together is left the probability `inadequate_known`.
  double most_chi2_per_dof = 2.0, inadequate_known = 0.05;
  std::uint64_t seed = 1;
};

struct Probabilities {
  std::vector<HypothesisProbability> hypotheses;  ///< most likely first, the unknown as one
  std::map<std::string, double> presence;
  std::vector<Verdict> credible_set;
};

/// Sums over as many blocks of time as there are, drawn with replacement, and over what is known.
NormalSums DrawBag(const LinearProblem& problem, std::mt19937_64& rng);

/// Leaves all that is known together the probability `known`, or less.
void SayUnknown(double known, std::map<Verdict, double>& probability);

/// The mean of what the whole recording says and what bags of its parts say together, each summing
/// to one, with every verdict in `whole`. But something unknown that shows in the whole and, to
/// less than 5 %, in its parts is no more likely than these say; the others share the rest.
std::map<Verdict, double> Agreed(const std::map<Verdict, double>& whole,
                                 const std::map<Verdict, double>& bagged);

/// Averages over bags of blocks of time: what hangs on a few seconds of the recording counts less.
Probabilities MakeProbabilities(const Selection& selection, const ParameterLayout& layout,
                                const SelectionOptions& selection_options,
                                const ProbabilityOptions& options = {});

/// The names of a hypothesis' effects, sorted; none and unknown by those names.
Verdict VerdictOf(const Hypothesis& hypothesis, const ParameterLayout& layout);

}  // namespace flextip::diagnosis
