// What the extended model gains on parts of the recording that it was not fitted to.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

struct HeldOut {
  ModelScore base, extended;
  Gain gain;
};

/// The recording falls into `folds` stretches of time; each is predicted with parameters fitted to
/// the others. `base` stands at the base simulation (registration at its best), `extended` at the
/// best point of `selection`, whose hypothesis `weighed` is extended with.
HeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, int folds = 4);

/// The best parameters of the base simulation: the registration's alone, the rest zero.
Eigen::VectorXd BaseParameters(const NormalSums& sums, const ParameterLayout& layout);

}  // namespace flextip::diagnosis
