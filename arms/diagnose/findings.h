// What the numbers of an answer say, in words and lists.
#pragma once

#include <string>
#include <vector>

#include "arms/search/search.h"
#include "diagnosis/model/effect.h"

namespace flextip::arms {

bool Holds(const diagnosis::Hypothesis& h, int block);

/// Returns a block's numbers as its effect reports them.
std::vector<diagnosis::ReportedParameter> Reported(const Layout& layout, const Layout::Block& block,
                                                   const Eigen::VectorXd& theta,
                                                   const Eigen::MatrixXd& covariance);

/// Returns a sentence for each list of numbers of present effects that the data leave as wide as
/// they were thought to be, with the effect that takes them up.
std::vector<std::string> NotTold(const Layout& layout, const diagnosis::WeighedHypothesis& weighed,
                                 const Eigen::MatrixXd& covariance);

/// Returns what each joint's own numbers say.
std::vector<std::string> JointFindings(const Layout& layout, const diagnosis::Hypothesis& best,
                                       const Eigen::VectorXd& theta,
                                       const Eigen::MatrixXd& covariance);

/// Returns groups of effects that explain as well as those of the verdict.
std::vector<std::vector<std::string>> Alternatives(const Found& found, const Layout& layout);

}  // namespace flextip::arms
