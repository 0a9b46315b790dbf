#include "arms/diagnose/describe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;
using diagnosis::ReportedParameter;
using diagnosis::Verdict;

constexpr double kCannotTell = 0.5;        // posterior over prior deviation
constexpr double kAsGood = 3.0;            // log odds
constexpr Eigen::Index kMostPoints = 600;  // of a curve
constexpr Eigen::Index kMostRows = 3000;   // of the table of residuals
constexpr double kTakenUp = 0.7;           // correlation with what takes a number up

std::vector<ReportedParameter> Reported(const Layout& layout, const Layout::Block& block,
                                        const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) {
  std::vector<ReportedParameter> reported;
  const auto own =
      block.effect->Report(layout.DataOf(block), theta.segment(block.first, block.size),
                           covariance.block(block.first, block.first, block.size, block.size));
  for (const ArmParameter& p : own) reported.push_back({p.name, p.value, p.sd});
  return reported;
}

bool Holds(const diagnosis::Hypothesis& h, int block) {
  return std::find(h.effects.begin(), h.effects.end(), block) != h.effects.end();
}

/// "joint_offset.offset[5]": the j-th number of a block as reported in order.
std::string NumberName(const Layout& layout, const Layout::Block& block, int j) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(block.size);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(block.size, block.size);
  int at = 0;
  for (const ArmParameter& p : block.effect->Report(layout.DataOf(block), zero, none)) {
    const int size = int(p.value.size());
    if (j < at + size) {
      return size == 1 ? fmt::format("{}.{}", block.effect->Name(), p.name)
                       : fmt::format("{}.{}[{}]", block.effect->Name(), p.name, j - at);
    }
    at += size;
  }
  return block.effect->Name();
}

/// Where a number of present effects stands: its list, and what takes it up.
struct LooseNumber {
  std::string list, taken_by;
  int index = 0;
};

LooseNumber MakeLoose(const Layout& layout, const Layout::Block& block, int j, int partner) {
  LooseNumber loose;
  const std::string name = NumberName(layout, block, j - block.first);
  const auto bracket = name.find('[');
  loose.list = name.substr(0, bracket);
  if (bracket != std::string::npos) loose.index = std::stoi(name.substr(bracket + 1)) + 1;
  for (const Layout::Block& rival : layout.Blocks())
    if (partner >= rival.first && partner < rival.first + rival.size)
      loose.taken_by = rival.effect->Name();
  return loose;
}

/// Numbers of present effects that the data leave as wide as they were thought to be, with the
/// effect that takes them up: a sentence for each list.
std::vector<std::string> NotTold(const Layout& layout, const diagnosis::WeighedHypothesis& weighed,
                                 const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd wide = layout.Prior().Widened(weighed.hypothesis.effects, weighed.scales);
  std::map<std::pair<std::string, std::string>, std::vector<int>> lists;
  for (const int b : weighed.hypothesis.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    for (int j = block.first; j < block.first + block.size; ++j) {
      if (std::sqrt(std::max(0.0, covariance(j, j))) < kCannotTell * wide[j]) continue;
      int partner = -1;
      double most = kTakenUp;
      for (int other = 0; other < layout.Size(); ++other) {
        if (other == j) continue;
        const double scale = std::sqrt(covariance(j, j) * covariance(other, other));
        const double c = scale > 0.0 ? std::abs(covariance(j, other)) / scale : 0.0;
        if (c <= most) continue;
        most = c;
        partner = other;
      }
      const LooseNumber loose = MakeLoose(layout, block, j, partner);
      lists[{loose.list, loose.taken_by}].push_back(loose.index);
    }
  }
  std::vector<std::string> not_told;
  for (const auto& [names, indices] : lists) {
    std::string text = names.first;
    if (indices.front() > 0) text += fmt::format(" {}", fmt::join(indices, ", "));
    text += names.second.empty() ? ": nothing in the recording shows it"
                                 : " cannot be told from " + names.second;
    not_told.push_back(std::move(text));
  }
  return not_told;
}

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

/// What each joint's own numbers say.
std::vector<std::string> JointFindings(const Layout& layout, const diagnosis::Hypothesis& best,
                                       const Eigen::VectorXd& theta,
                                       const Eigen::MatrixXd& covariance) {
  const ArmData& data = layout.Recordings().front();
  std::vector<std::string> findings(data.Size());
  for (const int b : best.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    for (const auto& p : Reported(layout, block, theta, covariance)) {
      if (int(p.value.size()) != data.Size() || p.name == "window") continue;
      for (int i = 0; i < data.Size(); ++i) {
        const double nominal = p.name == "scale" ? 1.0 : 0.0;
        const double tolerance =
            layout.Prior().Tolerances()[block.first + std::min(i, block.size - 1)];
        const double off = std::abs(p.value[i] - nominal);
        if (off < 3.0 * p.sd[i] || off < 3.0 * tolerance) continue;
        std::string& text = findings[i];
        if (!text.empty()) text += "; ";
        text += fmt::format("{} {} {:.4g}", block.effect->Name(), p.name, p.value[i]);
      }
    }
  }
  return findings;
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

/// Groups of effects that explain as well as those of the verdict.
std::vector<std::vector<std::string>> Alternatives(const Found& found, const Layout& layout) {
  std::vector<std::vector<std::string>> groups;
  const Scored& best = found.BestKnown();
  for (const int b : best.weighed.hypothesis.effects) {
    if (layout.Blocks()[b].change) continue;
    std::vector<std::string> group{layout.Blocks()[b].effect->Name()};
    for (const Scored& s : found.scored) {
      const auto& other = s.weighed.hypothesis;
      if (other.unknown || other.effects.size() != best.weighed.hypothesis.effects.size()) continue;
      if (s.log_posterior < best.log_posterior - kAsGood || Holds(other, b)) continue;
      int replaced = -1, differ = 0;
      for (const int e : other.effects)
        if (!Holds(best.weighed.hypothesis, e)) {
          replaced = e;
          ++differ;
        }
      if (differ != 1) continue;
      const std::string name = layout.Blocks()[replaced].effect->Name();
      if (std::find(group.begin(), group.end(), name) == group.end()) group.push_back(name);
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

void FillSignatures(const Replay& base, const Noise& noise, diagnosis::DiagnosisResult& answer) {
  const Basis basis(base);
  const ArmData& data = base.GetLayout().Recordings().front();
  std::vector<std::string> names{"time"};
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}", i + 1));
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}_squared", i + 1));
  for (int i = 0; i < data.Size(); ++i) names.push_back(fmt::format("q{}_direction", i + 1));
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = base.Channels()[i];
    for (Eigen::Index c = 0; c < channel.Components(); ++c)
      for (std::size_t f = 0; f < names.size(); ++f) {
        double xy = 0.0, xx = 0.0, yy = 0.0, count = 0.0;
        for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
          if (!noise[i].keep(k, c)) continue;
          const double x = basis.Of(i)(k, Eigen::Index(f)), y = channel.residual(k, c);
          xy += x * y;
          xx += x * x;
          yy += y * y;
          count += 1.0;
        }
        if (xx * yy <= 0.0) continue;
        const double score = std::abs(xy) / std::sqrt(xx * yy) * std::sqrt(count);
        if (score > 3.0)
          answer.signatures.push_back(
              {std::string(Name(channel.kind)) + "_" + channel.components[c], names[f], score});
      }
  }
  std::stable_sort(answer.signatures.begin(), answer.signatures.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  if (answer.signatures.size() > 40) answer.signatures.resize(40);
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

Residuals ResidualsOf(const Replay& replay) {
  Residuals all;
  for (const Channel& channel : replay.Channels()) all.push_back(channel.residual);
  return all;
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

void FillCurves(const Replay& replay, const Residuals& base, const Residuals& extended,
                std::vector<ComponentCurve>& curves) {
  const auto& recordings = replay.GetLayout().Recordings();
  for (std::size_t i = 0; i < replay.Channels().size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    const ArmData& data = recordings[channel.recording];
    if (channel.kind == Kind::kPose) continue;
    const bool torque = channel.kind == Kind::kTorque;
    const Measured& measured = torque                        ? data.torque
                               : channel.kind == Kind::kSeen ? data.seen
                                                             : data.followed;
    const Eigen::MatrixXd& input =
        channel.kind == Kind::kFollowed ? data.command.values : data.joints.values;
    const Eigen::Index every = 1 + channel.Rows() / kMostPoints;
    for (Eigen::Index c = 0; c < channel.Components(); ++c) {
      ComponentCurve curve;
      curve.channel = Name(channel.kind);
      curve.component = channel.components[c];
      curve.recording = channel.recording;
      for (Eigen::Index k = 0; k < channel.Rows(); k += every) {
        const double z = measured.track.values(k, c);
        curve.t_s.push_back(channel.t_s[k]);
        curve.input.push_back(At(input, channel.where[k])[c]);
        curve.measured.push_back(z);
        curve.base.push_back(z - base[i](k, c));
        curve.extended.push_back(z - extended[i](k, c));
      }
      curves.push_back(std::move(curve));
    }
  }
}

diagnosis::ResidualTable ResidualTableOf(const Replay& replay, const Residuals& base,
                                         const Residuals& extended, const Noise& noise) {
  diagnosis::ResidualTable table;
  table.columns = {"t_s"};
  std::vector<std::size_t> first(replay.Channels().size(), 0);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (channel.recording != 0) continue;
    first[i] = table.columns.size();
    for (const char* model : {"base", "extended"})
      for (Eigen::Index c = 0; c < channel.Components(); ++c)
        table.columns.push_back(fmt::format("{}.{}.{}", model, Name(channel.kind), c + 1));
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (channel.recording != 0) continue;
    const Eigen::Index C = channel.Components(), every = 1 + channel.Rows() / kMostRows;
    for (Eigen::Index k = 0; k < channel.Rows(); k += every) {
      std::vector<double> row(table.columns.size(), 0.0);
      std::vector<bool> present(table.columns.size(), false);
      row[0] = channel.t_s[k];
      present[0] = true;
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const std::size_t at = first[i] + std::size_t(c);
        row[at] = base[i](k, c) / noise[i].floor[c];
        row[at + std::size_t(C)] = extended[i](k, c) / noise[i].floor[c];
        present[at] = present[at + std::size_t(C)] = true;
      }
      table.rows.push_back(std::move(row));
      table.present.push_back(std::move(present));
    }
  }
  return table;
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
  result.not_told = NotTold(layout, weighed, covariance);
  for (const int b : found.not_claimed)
    result.not_told.push_back(layout.Blocks()[b].effect->Name() +
                              ": what it explains is lost in what is left, not claimed");
  OrderByImportance(found, layout, answer.verdict);
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
