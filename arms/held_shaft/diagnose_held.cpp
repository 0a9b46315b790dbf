#include "arms/held_shaft/diagnose_held.h"

#include <algorithm>
#include <map>
#include <set>

#include "arms/effects/effects.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

using diagnosis::DiagnosisResult;
using diagnosis::EffectFit;
using diagnosis::Verdict;

const Verdict kUnknown{"unknown"};
constexpr double kLeastProbability = 1e-6;  // of a hypothesis that is multiplied with others
constexpr double kCredible = 0.9;

/// The effects of both, in alphabetical order; `none` is no effect.
Verdict Both(const Verdict& a, const Verdict& b) {
  if (a == kUnknown || b == kUnknown) return kUnknown;
  std::set<std::string> names;
  for (const Verdict& one : {a, b})
    if (diagnosis::NamesEffects(one)) names.insert(one.begin(), one.end());
  return names.empty() ? Verdict{"none"} : Verdict(names.begin(), names.end());
}

void Multiply(const DiagnosisResult& shaft, const DiagnosisResult& arm, DiagnosisResult& both) {
  std::map<Verdict, diagnosis::HypothesisProbability> all;
  double sum = 0.0;
  for (const auto& a : shaft.probabilities)
    for (const auto& b : arm.probabilities) {
      const double p = a.probability * b.probability;
      if (p < kLeastProbability && !all.empty()) continue;
      auto& one = all[Both(a.verdict, b.verdict)];
      one.probability += p;
      one.log_evidence = a.log_evidence + b.log_evidence;
      sum += p;
    }
  both.probabilities.clear();
  for (auto& [verdict, one] : all)
    both.probabilities.push_back({verdict, one.probability / sum, one.log_evidence});
  std::ranges::stable_sort(both.probabilities, [](const auto& x, const auto& y) {
    return x.probability > y.probability;
  });
  both.verdict = both.probabilities.front().verdict;
  both.credible_set.clear();
  double held = 0.0;
  for (const auto& one : both.probabilities) {
    if (held < kCredible) both.credible_set.push_back(one.verdict);
    held += one.probability;
  }
  for (const auto& [name, p] : arm.presence) {
    double& own = both.presence[name];
    own = 1.0 - (1.0 - own) * (1.0 - p);
  }
}

bool Has(const std::vector<EffectFit>& fits, const std::string& effect) {
  return std::ranges::any_of(fits, [&](const EffectFit& fit) { return fit.effect == effect; });
}

/// The arm's fits, and those of the shaft that it has not.
std::vector<EffectFit> Joined(const std::vector<EffectFit>& shaft,
                              const std::vector<EffectFit>& arm) {
  std::vector<EffectFit> all;
  for (const EffectFit& fit : shaft)
    if (!Has(arm, fit.effect)) all.push_back(fit);
  all.insert(all.end(), arm.begin(), arm.end());
  return all;
}

/// The names of `options.without` that one part knows.
std::vector<std::string> Known(const std::vector<std::string>& names,
                               const std::set<std::string>& known, bool wanted) {
  std::vector<std::string> kept;
  for (const std::string& name : names)
    if (known.contains(name) == wanted) kept.push_back(name);
  return kept;
}

}  // namespace

DiagnosisResult Together(const DiagnosisResult& shaft, const DiagnosisResult& arm) {
  DiagnosisResult both = shaft;
  Multiply(shaft, arm, both);
  both.parameters = Joined(shaft.parameters, arm.parameters);
  std::vector<EffectFit> within;  // what one part names is not within tolerance in the other
  for (const EffectFit& fit : Joined(shaft.within_tolerance, arm.within_tolerance))
    if (!Has(both.parameters, fit.effect)) within.push_back(fit);
  both.within_tolerance = std::move(within);
  both.nominal = Joined(shaft.nominal, arm.nominal);
  both.covariance.resize(0, 0);                      // of a list that is no longer the shaft's
  for (const auto& group : arm.indistinguishable) {  // one of each effect
    const auto is_of_same = [&](const auto& own) { return own.front() == group.front(); };
    if (std::ranges::none_of(both.indistinguishable, is_of_same))
      both.indistinguishable.push_back(group);
  }
  for (const std::string& name : arm.catalogue)
    if (std::ranges::find(both.catalogue, name) == both.catalogue.end())
      both.catalogue.push_back(name);
  both.summaries.insert(arm.summaries.begin(), arm.summaries.end());
  both.warnings.insert(both.warnings.end(), arm.warnings.begin(), arm.warnings.end());
  both.fits += arm.fits;
  both.converged = shaft.converged && arm.converged;
  return both;
}

HeldResult DiagnoseHeld(const HeldShaft& held, const Recording& recording, const std::string& name,
                        const diagnosis::DiagnoseOptions& options) {
  if (options.plan) {
    throw InputError(name +
                     ": an arm holds the shaft, and a planned motion is of a wrist without joints: "
                     "expected no plan");
  }
  std::set<std::string> of_arm{"payload"};
  for (const auto& effect : MakeEffects(held.Data().arm)) of_arm.insert(effect->Name());
  const std::vector<std::string> joints = held.Names();
  diagnosis::DiagnoseOptions of_shaft = options;
  of_shaft.own_effects = held.Effects();
  of_shaft.suggest_motion = false;  // of a motion that is imagined the joints are not known
  std::set<std::string> of_arm_alone = of_arm;
  for (const std::string& joint : joints) of_arm_alone.erase(joint);
  of_shaft.without = Known(options.without, of_arm_alone, false);
  HeldResult result;
  result.shaft = result.answer = diagnosis::Diagnose(recording, name, of_shaft);
  if (!held.Data().CanBeJudged()) return result;
  result.arm = Diagnose({held.Data()}, {.without = Known(options.without, of_arm, true)});
  result.answer = Together(result.shaft, result.arm->answer);
  return result;
}

}  // namespace flextip::arms
