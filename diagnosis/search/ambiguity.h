// Which effects a recording cannot tell apart, and the motion that would.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

/// How far apart two explanations are in data of this kind: twice the log odds that the signal of
/// `blocks` with parameters `theta` (others at zero) would give them over the hypothesis in which
/// `other` stands in the place of `replaced`. Below about kInseparable nobody could say.
double Separation(const LinearProblem& problem, const ParameterLayout& layout,
                  const Eigen::VectorXd& generic_sd, const Eigen::VectorXd& theta,
                  const std::vector<int>& blocks, int replaced, int other);

inline constexpr double kInseparable = 9.0;

struct Ambiguity {
  std::vector<std::vector<int>> groups;  ///< for each effect of the verdict: it and its like
  std::string separating_motion;
  double separating_score = 0.0;  ///< the worst separation with that motion
};

/// For the verdict `weighed`, at the point where `replay` stands; the motion only where asked for.
Ambiguity FindAmbiguity(const Replay& replay, const ParameterLayout& layout,
                        const Selection& selection, const WeighedHypothesis& weighed,
                        bool find_motion = true);

}  // namespace flextip::diagnosis
