// What the true model leaves of a recording, measured as the held-out error of the diagnosis's
// models is (diagnosis/heldout.h): the least that an extended model should be held to.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "bench/diagnosis_matrix/true_model.h"
#include "diagnosis/evidence/linear_problem.h"

namespace flextip::bench {

/// `theta` with its entries `free` where they explain `sums` best, each with a normal prior about
/// zero of standard deviation `prior_sd`; the others stay as they are.
Eigen::VectorXd FitFree(const diagnosis::NormalSums& sums, const std::vector<int>& free,
                        const Eigen::VectorXd& prior_sd, Eigen::VectorXd theta);

/// Root mean square of all measured rows in standard deviations of their noise, the data sheets'
/// times `noise_scale` by channel: ModelScore::weighted_rms of the true model. What a fair
/// comparison needs is this. The samples, the four stretches of time, and the noise are those of
/// the diagnosis; an unknown tip force is found from the very sample's sensors in both. The label's
/// parameters of all effects, those within tolerance too, are known and nothing of them is fitted.
/// What the label does not name (TrueParameters::unnamed) nobody is told: that is fitted to the
/// other three stretches, as the base simulation's registration is. The truth can be beaten where
/// the plant's form is not the model's (TrueModel), as a fit mends that form and the label does
/// not. 0 where the model has no equilibrium.
double TrueHeldOutError(TrueModel& truth,
                        const std::array<double, diagnosis::kChannelCount>& noise_scale);

}  // namespace flextip::bench
