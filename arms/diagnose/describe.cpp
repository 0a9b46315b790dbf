#include "arms/diagnose/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "arms/diagnose/curves.h"
#include "arms/diagnose/findings.h"
#include "arms/diagnose/side_view.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;
using diagnosis::Verdict;

/// Puts first what explains most.
void OrderByImportance(const Found& found, const Layout& layout, Verdict& verdict) {
  const auto of = [&](const std::string& name) {
    double most = -1.0;
    for (const auto& [block, importance] : found.importance)
      if (layout.Blocks()[block].effect->Name() == name) most = std::max(most, importance);
    return most;
  };
  std::stable_sort(verdict.begin(), verdict.end(),
                   [&](const std::string& a, const std::string& b) { return of(a) > of(b); });
}

diagnosis::ModelScore ScoreOf(const ErrorSums& sums, double chi2) {
  diagnosis::ModelScore score;
  for (const auto& [name, s] : sums.by_name) score.heldout_rms[name] = sums.Rms(name);
  score.tip_prediction_rms_m = sums.Tip();
  score.weighted_rms = sums.Weighted();
  score.chi2_per_dof = chi2;
  return score;
}

diagnosis::Gain GainOf(const ErrorSums& base, const ErrorSums& extended) {
  diagnosis::Gain gain;
  gain.measured = base.Weighted() > 0.0;
  if (gain.measured) gain.heldout_error_ratio = extended.Weighted() / base.Weighted();
  if (base.Tip() > 0.0) gain.tip_error_ratio = extended.Tip() / base.Tip();
  gain.heldout_error_ratio_low = gain.heldout_error_ratio_high = gain.heldout_error_ratio;
  return gain;
}

void FillComponents(const Replay& extended, const Found& found, const ArmHeldOut& heldout,
                    ArmResult& result) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < found.noise.size(); ++i) {
    const Channel& channel = extended.Channels()[i];
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      const std::string name = std::string(Name(channel.kind)) + "_" + channel.components[c];
      if (!found.noise[i].keep.col(c).any() || !seen.insert(name).second) continue;
      result.components.push_back({Name(channel.kind), channel.components[c],
                                   channel.kind == Kind::kPose ? -1 : int(c),
                                   found.noise[i].floor[c], found.noise[i].memory[c],
                                   heldout.base.Rms(name), heldout.extended.Rms(name)});
    }
  }
}

/// Effects for another recording: what lasts from a recording on counts by the part of recordings
/// that have it.
std::vector<EffectFit> WithMeanChanges(const Layout& layout, const diagnosis::Hypothesis& best,
                                       const Eigen::VectorXd& theta,
                                       const Eigen::MatrixXd& covariance,
                                       std::vector<EffectFit> effects) {
  std::map<std::string, Eigen::VectorXd> mean;
  for (const int b : best.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    if (block.effect->ComesAndGoes()) continue;
    const double part =
        double(std::count(block.in.begin(), block.in.end(), true)) / double(block.in.size());
    auto [at, fresh] = mean.try_emplace(block.effect->Name(), Eigen::VectorXd::Zero(block.size));
    at->second += (block.change ? part : 1.0) * theta.segment(block.first, block.size);
  }
  for (const int b : best.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    if (!block.change || block.effect->ComesAndGoes()) continue;
    const std::string name = block.effect->Name();
    Eigen::VectorXd moved = theta;
    moved.segment(block.first, block.size) = mean.at(name);
    const EffectFit fit{name, Reported(layout, block, moved, covariance)};
    const auto found = std::find_if(effects.begin(), effects.end(),
                                    [&](const EffectFit& e) { return e.effect == name; });
    if (found == effects.end())
      effects.push_back(fit);
    else
      *found = fit;
  }
  return effects;
}

/// How likely each effect is in each recording. `p`: of each scored hypothesis.
std::map<std::string, std::vector<double>> PresenceIn(const Found& found,
                                                      const std::vector<double>& p,
                                                      const Layout& layout) {
  std::map<std::string, std::vector<double>> presence;
  for (std::size_t i = 0; i < found.scored.size(); ++i) {
    if (found.scored[i].weighed.hypothesis.unknown || p[i] <= 0.0) continue;
    for (std::size_t r = 0; r < layout.Recordings().size(); ++r) {
      for (const std::string& name :
           VerdictIn(found.scored[i].weighed.hypothesis, layout, int(r))) {
        if (name == "none") continue;
        presence.try_emplace(name, layout.Recordings().size(), 0.0).first->second[r] += p[i];
      }
    }
  }
  return presence;
}

}  // namespace

Verdict VerdictIn(const diagnosis::Hypothesis& hypothesis, const Layout& layout, int only) {
  if (hypothesis.unknown) return {"unknown"};
  std::set<std::string> names;
  for (const int b : hypothesis.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    if (only < 0 ? !block.change : bool(block.in[only])) names.insert(block.effect->Name());
  }
  if (names.empty()) return {"none"};
  return {names.begin(), names.end()};
}

void Describe(const Replay& base, const Replay& extended, const Found& found,
              const ArmHeldOut& heldout, const std::vector<double>& p, ArmResult& result) {
  const Layout& layout = extended.GetLayout();
  const auto& weighed = found.BestKnown().weighed;
  const auto& best = weighed.hypothesis;
  const diagnosis::Evidence evidence(found.problem.total, layout.Prior(), found.generic_sd,
                                     {.scales = {0.3, 3.0}, .unknown_sd = {}});
  const Eigen::MatrixXd covariance =
      evidence.Covariance(weighed).topLeftCorner(layout.Size(), layout.Size());
  Eigen::VectorXd theta = extended.Theta();
  for (int j = 0; j < layout.Size(); ++j)
    if (layout.Prior().Parameter(j).positive) theta[j] = std::max(0.0, theta[j]);
  diagnosis::DiagnosisResult& answer = result.answer;
  for (const ArmData& data : layout.Recordings()) {
    result.recordings.push_back(data.name);
    answer.samples += int(data.joints.Rows());
  }
  for (int b = 0; b < int(layout.Blocks().size()); ++b) {
    const Layout::Block& block = layout.Blocks()[b];
    EffectFit fit{block.effect->Name(), Reported(layout, block, theta, covariance)};
    if (b >= layout.EffectCount()) {
      EffectFit of_base{block.effect->Name(), Reported(layout, block, base.Theta(), covariance)};
      if (block.effect->OwnInEach()) continue;
      result.model.nuisances.push_back(fit);
      result.model.base_nuisances.push_back(of_base);
      continue;
    }
    const bool present = Holds(best, b);
    double probability = 0.0;
    for (std::size_t i = 0; i < found.scored.size(); ++i)
      if (Holds(found.scored[i].weighed.hypothesis, b)) probability += p[i];
    if (block.change) {
      if (present && probability > 0.5)
        result.changes.push_back({fit.effect, block.first_in, probability, fit.parameters});
      continue;
    }
    if (present)
      answer.parameters.push_back(fit);
    else if (fit.effect != "payload")
      answer.within_tolerance.push_back(fit);
    const Eigen::VectorXd tolerance = layout.Prior().Tolerances();
    answer.catalogue.push_back(fit.effect);
    answer.summaries[fit.effect] = block.effect->Summary();
  }
  result.model.effects = WithMeanChanges(layout, best, theta, covariance, answer.parameters);
  result.model.within_tolerance = answer.within_tolerance;
  if (diagnosis::NamesEffects(answer.verdict))
    answer.indistinguishable = Alternatives(found, layout);
  if (layout.Recordings().size() > 1) result.presence_in = PresenceIn(found, p, layout);
  result.not_told = NotTold(layout, weighed, covariance);
  for (const int b : found.not_claimed)
    result.not_told.push_back(layout.Blocks()[b].effect->Name() +
                              ": what it explains is lost in what is left, not claimed");
  OrderByImportance(found, layout, answer.verdict);
  result.side_view = SideView(layout.Recordings().front());
  result.joint_findings = JointFindings(layout, best, theta, covariance);
  for (const ArmJoint& joint : layout.Recordings().front().arm.joints)
    result.joint_types.emplace_back(joint.type == JointType::kRevolute ? "revolute" : "prismatic");
  answer.base = ScoreOf(heldout.base, answer.base.chi2_per_dof);
  answer.extended = ScoreOf(heldout.extended, answer.extended.chi2_per_dof);
  answer.gain = GainOf(heldout.base, heldout.extended);
  answer.gain.heldout_error_ratio_low = heldout.low;
  answer.gain.heldout_error_ratio_high = heldout.high;
  answer.fits = found.fits;
  answer.converged = found.converged;
  answer.noise_scale.fill(1.0);
  for (std::size_t i = 0; i < found.noise.size(); ++i) {
    const Channel& channel = extended.Channels()[i];
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      const double slow = std::pow(found.noise[i].sd[c] / found.noise[i].floor[c], 2);
      if (slow <= answer.memory.slow_variance) continue;
      answer.memory = {std::string(Name(channel.kind)) + "_" + channel.components[c],
                       found.noise[i].memory[c], slow};
    }
  }
  if (const long left = LeftOut(extended, found.noise); left > 0)
    answer.warnings.push_back(
        fmt::format("{} single readings are far from all others: left out", left));
  answer.residuals =
      ResidualTableOf(extended, ResidualsOf(base), ResidualsOf(extended), found.noise);
  FillSignatures(base, found.noise, answer);
  FillComponents(extended, found, heldout, result);
  FillCurves(extended, ResidualsOf(base), ResidualsOf(extended), result.curves);
}

void DescribeRecording(const Replay& extended, const Found& found, const ArmHeldOut& heldout, int r,
                       const ArmResult& result, diagnosis::DiagnosisResult& answer) {
  const Layout& layout = extended.GetLayout();
  answer.base = ScoreOf(heldout.base_recordings[r], result.answer.base.chi2_per_dof);
  answer.extended = ScoreOf(heldout.extended_recordings[r], result.answer.extended.chi2_per_dof);
  answer.gain = GainOf(heldout.base_recordings[r], heldout.extended_recordings[r]);
  answer.parameters = result.answer.parameters;
  for (const Change& change : result.changes) {
    for (const int b : found.BestKnown().weighed.hypothesis.effects) {
      const Layout::Block& block = layout.Blocks()[b];
      if (block.change && block.in[r] && block.effect->Name() == change.effect &&
          block.first_in == change.first_in)
        answer.parameters.push_back({change.effect, change.parameters});
    }
  }
  answer.samples = int(layout.Recordings()[r].joints.Rows());
  answer.converged = result.answer.converged;
  answer.memory = result.answer.memory;
  answer.noise_scale.fill(1.0);
  answer.catalogue = result.answer.catalogue;
  answer.summaries = result.answer.summaries;
}

}  // namespace flextip::arms
