#include "diagnosis/several/judge_member.h"

#include <fmt/format.h>

#include <random>
#include <utility>

#include "diagnosis/describe.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/planning/next_motion.h"
#include "diagnosis/several/reduced_sums.h"
#include "diagnosis/signature.h"

namespace flextip::diagnosis {
namespace {

constexpr double kBaggedUnknownSd = 0.3;  // of generic terms, in noise sd

/// A member at a place, by blocks of time, slow residuals counted as fewer samples.
struct MemberProblem {
  std::unique_ptr<Replay> extended;
  LinearProblem problem;
  Eigen::VectorXd generic_sd;
  ResidualMemory memory;

  MemberProblem(const Member& member, std::unique_ptr<Replay> replay,
                const SelectionOptions& options)
      : extended(std::move(replay)) {
    problem = ProblemHere(*extended, member.basis, options);
    generic_sd = GenericSd(problem, member.may_miss);
    std::vector<int> parameters, generic;
    for (int j = 0; j < problem.Size(); ++j)
      (j < problem.parameters ? parameters : generic).push_back(j);
    Eigen::VectorXd x(problem.Size());
    x << extended->Theta(),
        BestOf(problem.total, parameters, generic, generic_sd, extended->Theta());
    memory = MemoryOfResiduals(*extended, member.basis, problem, x);
    problem.CountAsOne(memory.SamplesAsOne());
  }
};

/// What the others know, of all unknowns of the member's problem.
NormalSums OfAllUnknowns(const NormalSums& of_parameters, const LinearProblem& problem) {
  NormalSums all(problem.Size());
  all.H.topLeftCorner(problem.parameters, problem.parameters) = of_parameters.H;
  all.g.head(problem.parameters) = of_parameters.g;
  all.c = of_parameters.c;
  all.volume = of_parameters.volume;
  return all;
}

Selection SelectionOf(const Member& member, MemberProblem& at, const MemberContext& context,
                      const SelectionOptions& options) {
  Selection selection;
  at.problem.Know(OfAllUnknowns(context.known, at.problem));
  selection.converged = context.converged;
  selection.fits = context.fits;
  selection.far_samples = member.far_samples;
  selection.chi2_per_dof = at.extended->ChiSquaredPerDof();
  selection.memory = at.memory;
  selection.problem = std::move(at.problem);
  selection.generic_sd = at.generic_sd;
  std::vector<Hypothesis> hypotheses = AllHypotheses(member.layout.EffectCount());
  if (context.present.size() > 2) hypotheses.push_back({context.present, false});
  const Evidence evidence(selection.problem.total, member.layout, selection.generic_sd);
  selection.scored = Score(evidence, member.layout.EffectCount(), hypotheses, options, {});
  return selection;
}

void DescribeCommon(const MemberProblem& at, const Selection& selection,
                    const MemberContext& context, JudgedMember& judged) {
  const Evidence evidence(selection.problem.total, at.extended->Layout(), selection.generic_sd,
                          {.unknown_sd = {}});
  const WeighedHypothesis weighed = evidence.Weigh({context.common, false});
  DiagnosisResult common;
  DescribeParameters(*at.extended, selection, weighed, common);
  if (context.names_effects) DescribeAmbiguity(*at.extended, selection, weighed, true, common);
  judged.common_parameters = common.parameters;
  judged.common_within_tolerance = common.within_tolerance;
  judged.common_covariance = common.covariance;
  judged.common_sensor_tolerance = common.sensor_tolerance;
  judged.common_groups = common.indistinguishable;
  judged.separating_motion = common.separating_motion;
  judged.separating_score = common.separating_motion_score;
}

}  // namespace

std::optional<MemberSums> SumMember(Member& member, const Place& place, int bags,
                                    std::uint64_t seed, const SelectionOptions& options) {
  auto replay = ReplayOf(member, place);
  if (!replay) return {};
  const MemberProblem at(member, std::move(replay), options);
  MemberSums sums;
  const auto with = [&](const NormalSums& of, double width) {
    return OfParameters(at.problem, of, at.generic_sd.cwiseMax(width));
  };
  sums.narrow = with(at.problem.total, 0.0);
  for (const double width : kUnknownWidths) sums.wide.push_back(with(at.problem.total, width));
  std::mt19937_64 rng(seed);
  for (int bag = 0; bag < bags; ++bag) {
    const NormalSums drawn = DrawBag(at.problem, rng);
    sums.bags.push_back(with(drawn, 0.0));
    sums.wide_bags.push_back(with(drawn, kBaggedUnknownSd));
  }
  sums.samples_as_one = at.memory.SamplesAsOne();
  sums.chi2_per_dof = at.extended->ChiSquaredPerDof();
  return sums;
}

std::optional<JudgedMember> JudgeMember(Member& member, const Place& place,
                                        const MemberContext& context,
                                        const DiagnoseOptions& options,
                                        const SelectionOptions& selection_options) {
  auto replay = ReplayOf(member, place);
  if (!replay) return {};
  JudgedMember judged;
  DiagnosisResult& result = judged.own;
  MemberProblem at(member, std::move(replay), selection_options);
  const Selection selection = SelectionOf(member, at, context, selection_options);
  Replay base(member.samples, member.layout);
  MoveToBase(base, member.name);
  result.signatures = FindSignatures(base);
  if (member.far_samples > 0) {
    result.warnings.push_back(
        fmt::format("{} of {} samples are far from what any model says: left out",
                    member.far_samples, member.samples.samples.size()));
  }
  result.memory = selection.memory;
  const Probabilities probabilities =
      MakeProbabilities(selection, member.layout, selection_options, {.bags = context.bags});
  result.probabilities = probabilities.hypotheses;
  result.presence = probabilities.presence;
  result.credible_set = probabilities.credible_set;
  result.verdict = probabilities.hypotheses.front().verdict;
  if (!result.IsAdequate()) result.warnings.push_back(MemoryWarning(selection.memory));
  const WeighedHypothesis& best = selection.BestKnown();
  DescribeParameters(*at.extended, selection, best, result);
  if (NamesEffects(result.verdict)) DescribeAmbiguity(*at.extended, selection, best, false, result);
  base.TakeSettings(*at.extended);
  if (options.measure_gain) {
    judged.heldout = MeasureHeldOut(base, *at.extended, selection, best);
    result.base = judged.heldout.base;
    result.extended = judged.heldout.extended;
    result.gain = judged.heldout.gain;
  }
  result.residuals = MakeResidualTable(base, *at.extended);
  DescribeRecording(*at.extended, selection, context.start_ns, result);
  if (options.plan && context.is_last)
    result.plan = PlanNextMotion(*at.extended, selection, result.indistinguishable, *options.plan);
  if (context.is_first) DescribeCommon(at, selection, context, judged);
  return judged;
}

}  // namespace flextip::diagnosis
