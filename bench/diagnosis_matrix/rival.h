// Which other explanation of the noise-free signal of one or two effects comes nearest to the true
// one: linear algebra on the problem about the truth.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/evidence/linear_problem.h"

namespace flextip::bench {

struct Separation {
  /// Twice the log likelihood that the true hypothesis has over its nearest rival, in data without
  /// noise of the effects' true size, each with the parameters that suit it best.
  double value = 0.0;
  /// "stiffness" or "length+stiffness"; "none" where the effects do not show enough to be told from
  /// nothing.
  std::string rival = "none";
};

/// A log likelihood ratio of 9. Rivals of as many effects have about the same prior odds, so it
/// leaves the wrong one odds of e^-9, about 1e-4: even noise of two standard deviations against the
/// truth (the ratio's own is the root of 2 x 9, 4.2) does not turn the answer. A single effect is
/// likelier beforehand than a pair by a factor of about 40, 3.7 of the 9.
inline constexpr double kSeparable = 18.0;

/// Standard deviations of the layout's parameters with the blocks of `present` widened to three
/// typical sizes, the widest prior that the diagnosis tries; the rest at its tolerance.
Eigen::VectorXd WidePrior(const diagnosis::ParameterLayout& layout,
                          const std::vector<int>& present);

/// The parameters' normal matrix X^T X with the generic terms, of prior `generic_sd`, at their
/// best: |X d + Y y|^2 + |y / generic_sd|^2, least over y, is d^T (this) d.
Eigen::MatrixXd WithoutGeneric(const diagnosis::LinearProblem& problem,
                               const Eigen::VectorXd& generic_sd);

/// Of the signal that the blocks of `present` (one to three, in order) make with parameters
/// `theta`. `H` is the parameters' normal matrix. A single effect's rivals are none and every other
/// single one; a pair's are none, every single one (its own two, too) and every other pair, and so
/// on for three. Simple ones come first: where one of them is nearer than kSeparable, larger ones
/// are not looked at.
Separation NearestRival(const Eigen::MatrixXd& H, const Eigen::VectorXd& theta,
                        const diagnosis::ParameterLayout& layout, const std::vector<int>& present);

/// Of the same signal, where the catalogue lacks the effects that make it: rivals are none and one
/// to three of all others.
Separation NearestWithout(const Eigen::MatrixXd& H, const Eigen::VectorXd& theta,
                          const diagnosis::ParameterLayout& layout,
                          const std::vector<int>& present);

/// Of a signal z that nothing of the catalogue makes, given by X^T z and z^T z: what the hypothesis
/// that explains most of it leaves. None, single effects and pairs are rivals.
Separation NearestKnown(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, double c,
                        const diagnosis::ParameterLayout& layout);

}  // namespace flextip::bench
