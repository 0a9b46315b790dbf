#include "diagnosis/several/diagnose_several.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "core/check.h"
#include "diagnosis/describe.h"
#include "diagnosis/heldout.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/planning/next_motion.h"
#include "diagnosis/several/joint_probabilities.h"
#include "diagnosis/signature.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kFew = 10;  // recordings that are judged part by part
constexpr int kBags = 8, kBagsOfMany = 2;

/// A member at the best place, by blocks of time, slow residuals counted as fewer samples.
struct MemberProblem {
  std::unique_ptr<Replay> extended;
  LinearProblem problem;
  Eigen::VectorXd generic_sd;
  ResidualMemory memory;

  MemberProblem(Member& member, const SelectionOptions& options)
      : extended(ReplayOf(member, member.place)) {
    FLEXTIP_CHECK(extended != nullptr, "a member stands where it has an equilibrium");
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

std::vector<MemberSums> AllSums(Fleet& fleet, const SelectionOptions& options) {
  std::vector<MemberSums> sums(fleet.Size());
  const int bags = fleet.Size() <= kFew ? kBags : kBagsOfMany;
  tbb::parallel_for(std::size_t{0}, fleet.Size(), [&](std::size_t r) {
    const MemberProblem at(fleet.At(r), options);
    sums[r] = SumsOf(at.problem, at.generic_sd, bags, r + 1);
    sums[r].samples_as_one = at.memory.SamplesAsOne();
    sums[r].chi2_per_dof = at.extended->ChiSquaredPerDof();
  });
  return sums;
}

/// What is known of all members, to judge one of them.
struct Known {
  const JointSelection& selection;
  const JointProbabilities& probabilities;
  const JointEvidence& evidence;
  const SelectionOptions& options;
  std::size_t recordings = 1;

  bool AreFew() const { return recordings <= kFew; }
};

Selection SelectionOf(std::size_t r, const Member& member, MemberProblem& at, const Known& known) {
  Selection selection;
  at.problem.Know([&] {
    const NormalSums of_parameters = known.evidence.KnownTo(r, known.probabilities.answer);
    NormalSums all(at.problem.Size());
    const int P = at.problem.parameters;
    all.H.topLeftCorner(P, P) = of_parameters.H;
    all.g.head(P) = of_parameters.g;
    all.c = of_parameters.c;
    all.volume = of_parameters.volume;
    return all;
  }());
  selection.converged = known.selection.converged;
  selection.fits = known.selection.fits;
  selection.far_samples = member.far_samples;
  selection.chi2_per_dof = at.extended->ChiSquaredPerDof();
  selection.memory = at.memory;
  selection.problem = std::move(at.problem);
  selection.generic_sd = at.generic_sd;
  std::vector<Hypothesis> hypotheses = AllHypotheses(member.layout.EffectCount());
  const Hypothesis here{known.probabilities.answer.hypothesis.EffectsIn(r), false};
  if (here.effects.size() > 2) hypotheses.push_back(here);
  const Evidence evidence(selection.problem.total, member.layout, selection.generic_sd);
  selection.scored = Score(evidence, member.layout.EffectCount(), hypotheses, known.options, {});
  return selection;
}

/// The answer of member `r`; `sums`: where its errors go.
struct Judged {
  DiagnosisResult own;
  std::vector<EffectFit> common_parameters, common_within_tolerance;
  Eigen::MatrixXd common_covariance;
  SensorTolerance common_sensor_tolerance;
  std::vector<std::vector<std::string>> common_groups;
  std::string separating_motion;
  double separating_score = 0.0;
  HeldOut heldout;
};

void DescribeCommon(const MemberProblem& at, const Selection& selection, const Known& known,
                    bool names_effects, Judged& judged) {
  const Evidence evidence(selection.problem.total, at.extended->Layout(), selection.generic_sd,
                          {.unknown_sd = {}});
  const WeighedHypothesis weighed =
      evidence.Weigh({known.probabilities.answer.hypothesis.effects, false});
  DiagnosisResult common;
  DescribeParameters(*at.extended, selection, weighed, common);
  if (names_effects) DescribeAmbiguity(*at.extended, selection, weighed, true, common);
  judged.common_parameters = common.parameters;
  judged.common_within_tolerance = common.within_tolerance;
  judged.common_covariance = common.covariance;
  judged.common_sensor_tolerance = common.sensor_tolerance;
  judged.common_groups = common.indistinguishable;
  judged.separating_motion = common.separating_motion;
  judged.separating_score = common.separating_motion_score;
}

Judged Judge(std::size_t r, Member& member, const NamedRecording& recording, const Known& known,
             const DiagnoseOptions& options) {
  Judged judged;
  DiagnosisResult& result = judged.own;
  MemberProblem at(member, known.options);
  const Selection selection = SelectionOf(r, member, at, known);
  Replay base(member.samples, member.layout);
  MoveToBase(base, member.name);
  result.signatures = FindSignatures(base);
  if (member.far_samples > 0) {
    result.warnings.push_back(
        fmt::format("{} of {} samples are far from what any model says: left out",
                    member.far_samples, member.samples.samples.size()));
  }
  result.memory = selection.memory;
  const Probabilities probabilities = MakeProbabilities(selection, member.layout, known.options,
                                                        {.bags = known.AreFew() ? kBags : 0});
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
  DescribeRecording(*at.extended, selection, recording.recording.wrist0->samples.front().t_ns,
                    result);
  if (options.plan && r + 1 == known.recordings)
    result.plan = PlanNextMotion(*at.extended, selection, result.indistinguishable, *options.plan);
  const Verdict& common = known.probabilities.common.hypotheses.front().verdict;
  if (r == 0) DescribeCommon(at, selection, known, NamesEffects(common), judged);
  return judged;
}

/// The strongest score of each pattern in any recording.
std::vector<Signature> Strongest(const std::vector<DiagnosisResult>& own) {
  std::map<std::pair<std::string, std::string>, double> scores;
  for (const DiagnosisResult& result : own)
    for (const Signature& s : result.signatures) {
      double& score = scores[{s.channel, s.against}];
      score = std::max(score, s.score);
    }
  std::vector<Signature> all;
  all.reserve(scores.size());
  for (const auto& [key, score] : scores) all.push_back({key.first, key.second, score});
  std::ranges::stable_sort(
      all, [](const Signature& a, const Signature& b) { return a.score > b.score; });
  return all;
}

/// One recording after the other, where they have the same columns.
ResidualTable Joined(const std::vector<DiagnosisResult>& own) {
  ResidualTable joined;
  double start_s = 0.0;
  for (const DiagnosisResult& result : own) {
    const ResidualTable& table = result.residuals;
    if (joined.columns.empty()) joined.columns = table.columns;
    if (table.columns != joined.columns || table.rows.empty()) continue;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
      joined.rows.push_back(table.rows[k]);
      joined.rows.back()[0] += start_s;
      joined.present.push_back(table.present[k]);
    }
    start_s = joined.rows.back()[0] + 1.0;
  }
  return joined;
}

DiagnosisResult CommonOf(const std::vector<Judged>& judged, const SeveralResult& several,
                         const Known& known) {
  DiagnosisResult common = judged.front().own;  // catalogue, nominal values, start and centre
  common.probabilities = known.probabilities.common.hypotheses;
  common.presence = known.probabilities.common.presence;
  common.credible_set = known.probabilities.common.credible_set;
  common.verdict = common.probabilities.front().verdict;
  common.parameters = judged.front().common_parameters;
  common.within_tolerance = judged.front().common_within_tolerance;
  common.covariance = judged.front().common_covariance;
  common.sensor_tolerance = judged.front().common_sensor_tolerance;
  common.indistinguishable = judged.front().common_groups;
  common.separating_motion = judged.front().separating_motion;
  common.separating_motion_score = judged.front().separating_score;
  common.plan = several.own.back().plan;
  common.signatures = Strongest(several.own);
  common.residuals = Joined(several.own);
  common.warnings.clear();
  common.samples = common.failed_samples = 0;
  std::vector<ErrorSums> base, extended;
  double base_chi2 = 0.0, extended_chi2 = 0.0;
  for (std::size_t r = 0; r < judged.size(); ++r) {
    const DiagnosisResult& own = several.own[r];
    const HeldOut& heldout = judged[r].heldout;
    base.insert(base.end(), heldout.base_sums.begin(), heldout.base_sums.end());
    extended.insert(extended.end(), heldout.extended_sums.begin(), heldout.extended_sums.end());
    base_chi2 += own.base.chi2_per_dof * own.samples;
    extended_chi2 += own.extended.chi2_per_dof * own.samples;
    common.samples += own.samples;
    common.failed_samples += own.failed_samples;
    if (own.memory.SamplesAsOne() > common.memory.SamplesAsOne()) common.memory = own.memory;
    for (std::size_t c = 0; c < common.noise_scale.size(); ++c)
      common.noise_scale[c] = std::max(common.noise_scale[c], own.noise_scale[c]);
    for (const std::string& warning : own.warnings)
      common.warnings.push_back(several.names[r] + ": " + warning);
  }
  if (base.empty()) return common;
  const HeldOut all = ScoreHeldOut(std::move(base), std::move(extended));
  common.base = all.base;
  common.extended = all.extended;
  common.gain = all.gain;
  common.base.chi2_per_dof = base_chi2 / common.samples;
  common.extended.chi2_per_dof = extended_chi2 / common.samples;
  return common;
}

std::vector<ReportedParameter> ParametersOf(const DiagnosisResult& result,
                                            const std::string& effect) {
  for (const auto* list : {&result.parameters, &result.within_tolerance})
    for (const EffectFit& fit : *list)
      if (fit.effect == effect) return fit.parameters;
  return {};
}

}  // namespace

SeveralResult DiagnoseSeveral(const std::vector<NamedRecording>& recordings,
                              const DiagnoseOptions& options) {
  RequireEffects(options.without, options.own_effects);
  const SelectionOptions selection_options;
  Fleet fleet(recordings, options);
  if (options.plan)
    RequireUsable(*options.plan, fleet.At(fleet.Size() - 1).samples, recordings.back().name);
  const JointSelection selection = SearchJointly(fleet, selection_options);
  const std::vector<MemberSums> sums = AllSums(fleet, selection_options);
  const JointProbabilities probabilities =
      MakeJointProbabilities(fleet, sums, selection, selection_options);
  std::vector<NormalSums> narrow;
  narrow.reserve(sums.size());
  for (const MemberSums& member : sums) narrow.push_back(member.narrow);
  const JointEvidence evidence(fleet, std::move(narrow));
  const Known known{selection, probabilities, evidence, selection_options, fleet.Size()};
  std::vector<Judged> judged(fleet.Size());
  tbb::parallel_for(std::size_t{0}, fleet.Size(), [&](std::size_t r) {
    judged[r] = Judge(r, fleet.At(r), recordings[r], known, options);
  });
  SeveralResult result;
  for (std::size_t r = 0; r < fleet.Size(); ++r) {
    result.names.push_back(recordings[r].name);
    result.own.push_back(judged[r].own);
  }
  for (const ProbableChange& found : probabilities.changes) {
    const std::string effect = fleet.Layout().Blocks()[found.change.effect].effect->Name();
    const auto first = std::size_t(found.change.first);
    result.changes.push_back(
        {effect, first, found.probability, ParametersOf(result.own[first], effect)});
  }
  result.common = CommonOf(judged, result, known);
  return result;
}

}  // namespace flextip::diagnosis
