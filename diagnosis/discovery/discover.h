// What the residuals of an answer hold that no effect of the catalogue explains: the terms, one
// after the other, as long as there is one that holds on blocks of time that it was not found on.
#pragma once

#include <vector>

#include "diagnosis/discovery/candidates.h"

namespace flextip::diagnosis {

/// What is less is no term.
struct LeastTerm {
  /// Of what the base within its tolerances leaves, squared: less does not matter.
  double part = 0.01;
  /// Of what the model leaves, noise included, squared: two hundredths of the error.
  double left = 0.04;
  double tolerances = 3.0;  ///< half of its range, in the target's tolerances
};

struct DiscoverOptions {
  int blocks = 20;
  int most_terms = 3;
  double most_false = 0.01;  ///< of a term: the probability that it is none
  double worth = 12.0;       ///< twice the log odds of the best form against no term
  LeastTerm least = {};
  LeastTerm least_first = least;  ///< of a first term, no other being known before
  double much_left = 0.1;  ///< of what the model leaves: what varies so much matters at any size
  /// Terms whose form a further one may complete (a wave's overtone), at any size that is not
  /// little of what the model leaves.
  std::vector<Term> completed = {};
  bool fast_waves_only = false;  ///< periodic terms as fast as noise, alone
  double alike = 9.0;            ///< twice the log odds within which forms cannot be told apart
  int bags = 8;
  bool certify = true;  ///< off: all terms that are worth their numbers, whether they hold or not
};

struct FoundTerm {
  Term term;
  std::vector<double> at_sd;
  double false_discovery = 1.0, stability = 0.0;
  std::vector<Candidate> rivals;  ///< other targets, variables or forms that explain as much
};

struct TermSearch {
  std::vector<FoundTerm> terms;
  double cost = 0.0;        ///< what the model and the terms leave, squared
  double complexity = 0.0;  ///< of the model's priors and of the terms, twice a logarithm
  double rows = 0.0;
};

/// Searches about the point where `replay` stands, its parameters with the priors `prior_sd`.
/// `before`: terms that are known already; they count with the model.
TermSearch SearchTerms(const Replay& replay, const Eigen::VectorXd& prior_sd,
                       const std::vector<FoundTerm>& before, const DiscoverOptions& options = {});

/// Twice the log odds of one search's model over another's of the same measurements. What the
/// better one leaves beyond the noise counts as noise.
double LogOdds(const TermSearch& one, const TermSearch& other);

}  // namespace flextip::diagnosis
