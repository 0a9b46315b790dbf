#include "diagnosis/diagnose.h"

#include <algorithm>

#include "core/error.h"
#include "diagnosis/describe.h"
#include "diagnosis/discovery/describe_terms.h"
#include "diagnosis/discovery/find_terms.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/heldout.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/planning/next_motion.h"
#include "diagnosis/signature.h"

namespace flextip::diagnosis {
namespace {

constexpr double kLongMemory = 0.5;  // a correlation that stands beside the answer

/// What the stages work on. The layout refers to the samples, the replays to both.
struct Work {
  SampleSet samples;
  ParameterLayout layout;
  Replay base, extended;

  Work(const Recording& recording, const std::string& name, const DiagnoseOptions& options)
      : samples(MakeSampleSet(recording, name)),
        layout(samples, MakeCatalogue(samples, options.without, options.own_effects)),
        base(samples, layout),
        extended(samples, layout) {}
};

/// Terms without a name explain the recording better than any effect: what the answer keeps of the
/// known causes is what it keeps where none of them is adequate.
void TurnUnknown(DiagnosisResult& result) {
  if (result.verdict == Verdict{"unknown"}) return;
  const double kept = ProbabilityOptions().inadequate_known;
  double known = 0.0;
  for (const auto& h : result.probabilities)
    if (h.verdict != Verdict{"unknown"}) known += h.probability;
  const double factor = known > kept ? kept / known : 1.0;
  for (auto& h : result.probabilities)
    h.probability = h.verdict == Verdict{"unknown"} ? 1.0 - factor * known : factor * h.probability;
  for (auto& [effect, presence] : result.presence) presence *= factor;
  std::stable_sort(result.probabilities.begin(), result.probabilities.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  result.verdict = {"unknown"};
  result.credible_set = {{"unknown"}};
}

}  // namespace

std::string Joined(const Verdict& verdict) {
  std::string joined;
  for (const auto& name : verdict) joined += (joined.empty() ? "" : "+") + name;
  return joined;
}

bool NamesEffects(const Verdict& verdict) {
  return verdict != Verdict{"none"} && verdict != Verdict{"unknown"};
}

bool DiagnosisResult::IsAdequate() const {
  if (memory.correlation <= kLongMemory) return true;
  if (verdict == Verdict{"unknown"})
    return true;  // the answer itself says that more is in the data
  // Where nothing is named, a slow rest that is smaller than the noise is no matter.
  return verdict == Verdict{"none"} && memory.SamplesAsOne() <= 1.0;
}

DiagnosisResult Diagnose(const Recording& recording, const std::string& name,
                         const DiagnoseOptions& options) {
  RequireEffects(options.without, options.own_effects);
  DiagnosisResult result;
  Work work(recording, name, options);
  if (options.plan) RequireUsable(*options.plan, work.samples, name);
  MoveToBase(work.base, name);
  result.signatures = FindSignatures(work.base);
  const SelectionOptions selection_options;
  const Selection selection = Select(work.extended, work.layout, selection_options);
  if (selection.far_samples > 0) {
    result.warnings.push_back(
        fmt::format("{} of {} samples are far from what any model says: left out",
                    selection.far_samples, work.samples.samples.size()));
  }
  result.memory = selection.memory;
  const Probabilities probabilities = MakeProbabilities(selection, work.layout, selection_options);
  result.probabilities = probabilities.hypotheses;
  result.presence = probabilities.presence;
  result.credible_set = probabilities.credible_set;
  result.verdict = probabilities.hypotheses.front().verdict;
  if (!result.IsAdequate()) result.warnings.push_back(MemoryWarning(selection.memory));
  const WeighedHypothesis& known = selection.BestKnown();
  work.base.TakeSettings(work.extended);
  std::unique_ptr<TermModel> terms;
  if (options.discover) terms = FindTerms(work.base, work.extended, selection, known, options);
  if (terms && !NamesEffects(terms->Named())) TurnUnknown(result);
  const Replay& base = terms ? terms->base : work.base;
  const Replay& extended = terms ? terms->extended : work.extended;
  const Selection& chosen = terms ? terms->selection : selection;
  const WeighedHypothesis& model = terms ? terms->weighed : known;
  if (NamesEffects(result.verdict))
    DescribeAmbiguity(work.extended, selection, known, options.suggest_motion, result);
  if (options.plan)
    result.plan = PlanNextMotion(work.extended, selection, result.indistinguishable, *options.plan);
  if (terms) result.discovered = DescribeTerms(*terms, options.measure_gain);
  DescribeParameters(extended, chosen, model, result, work.layout.EffectCount());
  if (options.measure_gain) {
    const HeldOut heldout = MeasureHeldOut(base, extended, chosen, model);
    result.base = heldout.base;
    result.extended = heldout.extended;
    result.gain = heldout.gain;
  }
  result.residuals = MakeResidualTable(base, extended);
  DescribeRecording(work.extended, selection, recording.wrist0->samples.front().t_ns, result);
  return result;
}

}  // namespace flextip::diagnosis
