#include "bench/diagnosis_matrix/separable.h"

#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/search/hypothesis_fit.h"

namespace flextip::bench {
namespace {

template <class Nearest>
Separation Apart(TrueModel& truth, const Nearest& nearest) {
  if (!truth.not_shown.empty())
    return {0.0, diagnosis::Joined(diagnosis::VerdictOf({truth.present, false}, truth.layout))};
  const auto information = InformationAtTruth(truth);
  if (!information) return {0.0, ""};
  return nearest(*information, truth.parameters.theta, truth.layout, truth.present);
}

}  // namespace

std::optional<Eigen::MatrixXd> InformationAtTruth(TrueModel& truth) {
  diagnosis::Replay& replay = truth.replay;
  if (!replay.Evaluate(Eigen::VectorXd::Zero(truth.layout.Size()))) return {};
  const diagnosis::SelectionOptions options;
  const diagnosis::Rows may_miss = diagnosis::MayMiss(
      diagnosis::ProblemHere(replay, diagnosis::GenericBasis(replay), options).residual_size,
      options.discrepancy, options);
  if (!truth.StandAtTruth()) return {};
  replay.SetNoiseScale(diagnosis::NoiseScale(replay));
  replay.Evaluate(truth.parameters.theta);
  const diagnosis::LinearProblem problem =
      diagnosis::MakeLinearProblem(replay, diagnosis::GenericBasis(replay), 1);
  return WithoutGeneric(problem, diagnosis::GenericSd(problem, may_miss));
}

Separation MeasureSeparation(TrueModel& truth) { return Apart(truth, NearestRival); }

Separation MeasureDeleted(TrueModel& truth) { return Apart(truth, NearestWithout); }

}  // namespace flextip::bench
