#include "bench/matrix_separable.h"

#include "diagnosis/generic_basis.h"
#include "diagnosis/hypothesis_fit.h"
#include "diagnosis/noise_level.h"
#include "diagnosis/probabilities.h"

namespace flextip {

Separation MeasureSeparation(TrueModel& truth) {
  if (!truth.not_shown.empty())
    return {0.0, Joined(VerdictOf({truth.present, false}, truth.layout))};
  Replay& replay = truth.replay;
  if (!replay.Evaluate(Eigen::VectorXd::Zero(truth.layout.Size()))) return {0.0, ""};
  const SelectionOptions options;
  const Rows may_miss =
      MayMiss(ProblemHere(replay, GenericBasis(replay), options), options.discrepancy, options);
  if (!truth.StandAtTruth()) return {0.0, ""};
  replay.SetNoiseScale(NoiseScale(replay));
  replay.Evaluate(truth.parameters.theta);
  const LinearProblem problem = MakeLinearProblem(replay, GenericBasis(replay), 1);
  return NearestRival(WithoutGeneric(problem, GenericSd(problem, may_miss)), truth.parameters.theta,
                      truth.layout, truth.present);
}

}  // namespace flextip
