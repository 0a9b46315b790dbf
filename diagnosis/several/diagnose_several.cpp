#include "diagnosis/several/diagnose_several.h"

#include <algorithm>
#include <map>

#include "diagnosis/heldout.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/planning/next_motion.h"
#include "diagnosis/several/joint_probabilities.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kFew = 10;  // recordings that are judged part by part
constexpr int kBags = 8, kBagsOfMany = 2;

std::vector<MemberSums> AllSums(const MemberWorkers& workers) {
  const Fleet& fleet = workers.Members();
  const int bags = fleet.Size() <= kFew ? kBags : kBagsOfMany;
  const auto sum_up = [&](std::size_t, Place place) -> MemberTask::What {
    return SumUp{std::move(place), bags};
  };
  std::vector<MemberSums> sums;
  for (MemberAnswer& answer : workers.DoWhereTheyStand(sum_up))
    sums.push_back(std::move(std::get<MemberSums>(answer)));
  return sums;
}

MemberContext ContextOf(std::size_t r, const MemberWorkers& workers,
                        const JointSelection& selection, const JointProbabilities& probabilities,
                        const JointEvidence& evidence) {
  const std::size_t size = workers.Members().Size();
  const JointHypothesis& answer = probabilities.answer.hypothesis;
  MemberContext context;
  context.known = evidence.KnownTo(r, probabilities.answer);
  context.present = answer.EffectsIn(r);
  context.common = answer.effects;
  context.names_effects = NamesEffects(probabilities.common.hypotheses.front().verdict);
  context.converged = selection.converged;
  context.fits = selection.fits;
  context.bags = size <= kFew ? kBags : 0;
  context.is_first = r == 0;
  context.is_last = r + 1 == size;
  return context;
}

std::vector<JudgedMember> JudgeAll(const MemberWorkers& workers,
                                   const std::vector<NamedRecording>& recordings,
                                   const JointSelection& selection,
                                   const std::vector<MemberSums>& sums,
                                   const JointProbabilities& probabilities) {
  std::vector<NormalSums> narrow;
  narrow.reserve(sums.size());
  for (const MemberSums& member : sums) narrow.push_back(member.narrow);
  const Fleet& fleet = workers.Members();
  const JointEvidence evidence(fleet, std::move(narrow));
  const auto judge = [&](std::size_t r, Place place) -> MemberTask::What {
    MemberContext context = ContextOf(r, workers, selection, probabilities, evidence);
    context.start_ns = recordings[r].recording.wrist0->samples.front().t_ns;
    return Judge{std::move(place), std::move(context)};
  };
  std::vector<JudgedMember> judged;
  for (MemberAnswer& answer : workers.DoWhereTheyStand(judge))
    judged.push_back(std::move(std::get<JudgedMember>(answer)));
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

DiagnosisResult CommonOf(const std::vector<JudgedMember>& judged, const SeveralResult& several,
                         const Probabilities& probabilities) {
  DiagnosisResult common = judged.front().own;  // catalogue, nominal values, start and centre
  common.probabilities = probabilities.hypotheses;
  common.presence = probabilities.presence;
  common.credible_set = probabilities.credible_set;
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
                              const DiagnoseOptions& options, const Helpers& helpers) {
  RequireEffects(options.without, options.own_effects);
  const SelectionOptions selection_options;
  Fleet fleet(recordings, options);
  if (options.plan)
    RequireUsable(*options.plan, fleet.At(fleet.Size() - 1).samples, recordings.back().name);
  const MemberWorkers workers(fleet, options, selection_options, helpers);
  const JointSelection selection = SearchJointly(workers);
  const std::vector<MemberSums> sums = AllSums(workers);
  const JointProbabilities probabilities =
      MakeJointProbabilities(fleet, sums, selection, selection_options);
  const std::vector<JudgedMember> judged =
      JudgeAll(workers, recordings, selection, sums, probabilities);
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
  result.common = CommonOf(judged, result, probabilities.common);
  return result;
}

}  // namespace flextip::diagnosis
