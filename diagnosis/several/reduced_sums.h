// Normal sums of which some unknowns are integrated out.
#pragma once

#include <vector>

#include "diagnosis/evidence/linear_problem.h"

namespace flextip::diagnosis {

/// What `sums` say of the unknowns `kept` once the unknowns `out`, each with a normal prior about
/// zero of deviation `sd`, are integrated out. The volume takes the determinant, so evidence by the
/// rest is that by all.
NormalSums IntegratedOut(const NormalSums& sums, const std::vector<int>& kept,
                         const std::vector<int>& out, const Eigen::VectorXd& sd);

/// The most likely unknowns `out` where `kept` have the values `x`.
Eigen::VectorXd BestOf(const NormalSums& sums, const std::vector<int>& kept,
                       const std::vector<int>& out, const Eigen::VectorXd& sd,
                       const Eigen::VectorXd& x);

/// What `problem` says of its parameters alone, generic terms with deviations `generic_sd`.
NormalSums OfParameters(const LinearProblem& problem, const NormalSums& sums,
                        const Eigen::VectorXd& generic_sd);

}  // namespace flextip::diagnosis
