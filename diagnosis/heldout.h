// What the extended model gains on parts of the recording that it was not fitted to.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/prediction/error_sums.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

struct HeldOut {
  ModelScore base, extended;
  Gain gain;
  std::vector<ErrorSums> base_sums, extended_sums;  ///< of stretches of time
};

/// Scores and gain of stretches of time; `chi2_per_dof` stays zero.
HeldOut ScoreHeldOut(std::vector<ErrorSums> base, std::vector<ErrorSums> extended);

/// The recording falls into `folds` stretches of time; each is predicted with parameters fitted to
/// the others. `base` stands at the base simulation (registration at its best), `extended` at the
/// best point of `selection`, whose hypothesis `weighed` is extended with.
HeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, int folds = 4);

/// Moves `base` to the base simulation, with the sensors' frames registered as well as the data
/// allow. Throws WorkError where that has no equilibrium; `name` is the recording's.
void MoveToBase(Replay& base, const std::string& name);

/// The best parameters of the base simulation: the registration's alone, the rest zero.
Eigen::VectorXd BaseParameters(const NormalSums& sums, const ParameterLayout& layout);

}  // namespace flextip::diagnosis
