#include "diagnosis/several/joint_evidence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/half_normal.h"

namespace flextip::diagnosis {
namespace {

const std::vector<double> kScales{0.3, 1.0, 3.0};  // of an effect's typical size

Eigen::MatrixXd Precision(const NormalSums& sums, const Eigen::VectorXd& sd) {
  Eigen::MatrixXd M = sd.asDiagonal() * sums.H * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  return M;
}

}  // namespace

std::vector<int> JointHypothesis::EffectsIn(std::size_t r) const {
  std::vector<int> present = effects;
  for (const Change& change : changes)
    if (int(r) >= change.first) present.push_back(change.effect);
  std::sort(present.begin(), present.end());
  return present;
}

JointEvidence::JointEvidence(const Fleet& fleet, std::vector<NormalSums> sums)
    : fleet_(fleet), sums_(std::move(sums)) {}

JointEvidence::Wide JointEvidence::WideIn(std::size_t r, const JointWeighed& weighed) const {
  Wide wide;
  const JointHypothesis& h = weighed.hypothesis;
  for (std::size_t i = 0; i < h.effects.size(); ++i)
    if (!fleet_.OwnOf(h.effects[i]).empty()) wide.emplace_back(h.effects[i], weighed.scales[i]);
  for (std::size_t i = 0; i < h.changes.size(); ++i) {
    const Change& change = h.changes[i];
    if (int(r) >= change.first && !fleet_.OwnOf(change.effect).empty())
      wide.emplace_back(change.effect, weighed.scales[h.effects.size() + i]);
  }
  std::sort(wide.begin(), wide.end());
  return wide;
}

/// All that is not shared: the effects' own parameters, and nuisances.
std::vector<int> JointEvidence::Out(const Member& member) const {
  std::vector<int> out;
  for (int e = 0; e < fleet_.EffectCount(); ++e)
    out.insert(out.end(), fleet_.OwnOf(e).begin(), fleet_.OwnOf(e).end());
  for (const auto& block : member.layout.Blocks())
    for (int j = block.first; block.nuisance && j < block.first + block.size; ++j) out.push_back(j);
  return out;
}

Eigen::VectorXd JointEvidence::OutSd(const Member& member, const Wide& wide) const {
  std::vector<int> effects;
  std::vector<double> scales;
  for (const auto& [effect, scale] : wide) {
    effects.push_back(effect);
    scales.push_back(scale);
  }
  return member.layout.Widened(effects, scales)(Out(member));
}

NormalSums JointEvidence::Reduced(std::size_t r, const Wide& wide) const {
  const Member& member = fleet_.At(r);
  return IntegratedOut(sums_[r], fleet_.Shared(), Out(member), OutSd(member, wide));
}

const std::vector<NormalSums>& JointEvidence::Cumulated(const Wide& wide) const {
  const std::lock_guard lock(mutex_);
  auto& sums = cumulated_[wide];
  if (!sums.empty()) return sums;
  sums.emplace_back(Eigen::Index(fleet_.Shared().size()));
  for (std::size_t r = 0; r < fleet_.Size(); ++r) {
    sums.push_back(sums.back());
    sums.back().Add(Reduced(r, wide));
  }
  return sums;
}

NormalSums JointEvidence::Range(const Wide& wide, std::size_t begin, std::size_t end) const {
  const std::vector<NormalSums>& sums = Cumulated(wide);
  NormalSums range = sums[end];
  if (begin > 0) range.Add(sums[begin], -1.0);
  return range;
}

NormalSums JointEvidence::From(std::size_t begin, const JointWeighed& weighed) const {
  std::set<std::size_t> ends{fleet_.Size()};
  for (const Change& change : weighed.hypothesis.changes) ends.insert(std::size_t(change.first));
  NormalSums sums(Eigen::Index(fleet_.Shared().size()));
  for (const std::size_t end : ends) {
    if (end <= begin) continue;
    sums.Add(Range(WideIn(begin, weighed), begin, end));
    begin = end;
  }
  return sums;
}

JointEvidence::Joint JointEvidence::Assemble(const JointWeighed& weighed) const {
  const JointHypothesis& h = weighed.hypothesis;
  const ParameterLayout& layout = fleet_.Layout();
  const auto S = Eigen::Index(fleet_.Shared().size());
  std::vector<Eigen::Index> at;  // of each change's parameters
  Eigen::Index size = S;
  std::set<std::size_t> firsts{0, fleet_.Size()};
  for (const Change& change : h.changes) {
    at.push_back(size);
    size += Eigen::Index(fleet_.SharedOf(change.effect).size());
    firsts.insert(std::size_t(change.first));
  }
  Joint joint;
  joint.sums = NormalSums(size);
  std::size_t begin = 0;
  for (const std::size_t end : firsts) {
    if (end == begin) continue;
    const NormalSums part = Range(WideIn(begin, weighed), begin, end);
    joint.sums.H.topLeftCorner(S, S) += part.H;
    joint.sums.g.head(S) += part.g;
    joint.sums.c += part.c;
    joint.sums.volume += part.volume;
    for (std::size_t i = 0; i < h.changes.size(); ++i) {
      if (int(begin) < h.changes[i].first) continue;
      const std::vector<int>& own = fleet_.SharedOf(h.changes[i].effect);
      const auto n = Eigen::Index(own.size());
      joint.sums.g.segment(at[i], n) += part.g(own);
      joint.sums.H.block(at[i], 0, n, S) += part.H(own, Eigen::all);
      joint.sums.H.block(0, at[i], S, n) += part.H(Eigen::all, own);
      for (std::size_t k = 0; k < h.changes.size(); ++k) {
        if (int(begin) < h.changes[k].first) continue;
        const std::vector<int>& other = fleet_.SharedOf(h.changes[k].effect);
        joint.sums.H.block(at[i], at[k], n, Eigen::Index(other.size())) += part.H(own, other);
      }
    }
    begin = end;
  }
  joint.sd.resize(size);
  const std::vector<double> of_effects(weighed.scales.begin(),
                                       weighed.scales.begin() + std::ptrdiff_t(h.effects.size()));
  joint.sd.head(S) = layout.Widened(h.effects, of_effects)(fleet_.Shared());
  for (const int e : h.effects)
    for (const int s : fleet_.SharedOf(e))
      if (layout.Parameter(fleet_.Shared()[s]).positive) joint.positive.push_back(s);
  for (std::size_t i = 0; i < h.changes.size(); ++i) {
    const int e = h.changes[i].effect;
    const Eigen::VectorXd sd = layout.Widened({e}, {weighed.scales[h.effects.size() + i]});
    const std::vector<int>& own = fleet_.SharedOf(e);
    for (std::size_t j = 0; j < own.size(); ++j) {
      const int parameter = fleet_.Shared()[own[j]];
      joint.sd[at[i] + Eigen::Index(j)] = sd[parameter];
      if (layout.Parameter(parameter).positive) joint.positive.push_back(int(at[i]) + int(j));
    }
  }
  return joint;
}

double JointEvidence::LogEvidence(const Joint& joint) const {
  const Llt llt(Precision(joint.sums, joint.sd));
  const Eigen::VectorXd g = joint.sd.asDiagonal() * joint.sums.g;
  const Eigen::VectorXd mean = llt.Solve(g);
  double log = 0.5 * (g.dot(mean) - llt.LogDeterminant() - joint.sums.c - joint.sums.volume);
  if (joint.positive.empty()) return log;
  const auto n = Eigen::Index(joint.positive.size());
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(g.size(), n);
  std::vector<int> all;
  for (Eigen::Index i = 0; i < n; ++i) {
    units(joint.positive[std::size_t(i)], i) = 1.0;
    all.push_back(int(i));
  }
  const Eigen::MatrixXd C = llt.Solve(units)(joint.positive, Eigen::all);
  return log + double(n) * std::log(2.0) + LogPositive(mean(joint.positive), C, all);
}

JointWeighed JointEvidence::Weigh(const JointHypothesis& hypothesis) const {
  JointWeighed weighed{hypothesis, 0.0, {}};
  const std::size_t count = hypothesis.effects.size() + hypothesis.changes.size();
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < count; ++i) combinations *= kScales.size();
  std::vector<double> logs;
  JointWeighed tried = weighed;
  for (std::size_t c = 0; c < combinations; ++c) {
    tried.scales.assign(count, 1.0);
    std::size_t rest = c;
    for (double& scale : tried.scales) {
      scale = kScales[rest % kScales.size()];
      rest /= kScales.size();
    }
    logs.push_back(LogEvidence(Assemble(tried)));
    if (logs.back() >= *std::max_element(logs.begin(), logs.end())) weighed.scales = tried.scales;
  }
  weighed.log_evidence = LogSumExp(logs) - std::log(double(combinations));
  return weighed;
}

std::vector<JointEvidence::AddedChange> JointEvidence::WithChanges(
    const JointWeighed& weighed) const {
  const Joint joint = Assemble(weighed);
  const Llt llt(Precision(joint.sums, joint.sd));
  const Eigen::MatrixXd C = joint.sd.asDiagonal() * llt.Inverse() * joint.sd.asDiagonal();
  const Eigen::VectorXd mean = C * joint.sums.g;
  const auto S = Eigen::Index(fleet_.Shared().size());
  const std::vector<int>& present = weighed.hypothesis.effects;
  std::vector<AddedChange> added;
  for (int first = 1; first < int(fleet_.Size()); ++first) {
    const std::vector<Change>& changes = weighed.hypothesis.changes;
    const auto from = [&](int begin) { return From(std::size_t(begin), weighed); };
    const NormalSums after = from(first);
    std::vector<NormalSums> after_both;
    after_both.reserve(changes.size());
    for (const Change& change : changes) after_both.push_back(from(std::max(first, change.first)));
    for (int e = 0; e < fleet_.EffectCount(); ++e) {
      const std::vector<int>& own = fleet_.SharedOf(e);
      if (own.empty() || !fleet_.OwnOf(e).empty()) continue;
      const auto is_there = [&](const Change& change) { return change.effect == e; };
      if (std::ranges::find(present, e) != present.end() || std::ranges::any_of(changes, is_there))
        continue;
      Eigen::MatrixXd B(Eigen::Index(own.size()), C.cols());
      B.leftCols(S) = after.H(own, Eigen::all);
      Eigen::Index at = S;
      for (std::size_t i = 0; i < changes.size(); ++i) {
        const std::vector<int>& other = fleet_.SharedOf(changes[i].effect);
        B.middleCols(at, Eigen::Index(other.size())) = after_both[i].H(own, other);
        at += Eigen::Index(other.size());
      }
      const Eigen::MatrixXd A = Eigen::MatrixXd(after.H(own, own)) - B * C * B.transpose();
      const Eigen::VectorXd b = Eigen::VectorXd(after.g(own)) - B * mean;
      std::vector<double> logs;
      for (const double scale : kScales) {
        Joint change;
        change.sums.H = A;
        change.sums.g = b;
        const Eigen::VectorXd sd = fleet_.Layout().Widened({e}, {scale});
        change.sd.resize(Eigen::Index(own.size()));
        for (std::size_t j = 0; j < own.size(); ++j) {
          change.sd[Eigen::Index(j)] = sd[fleet_.Shared()[own[j]]];
          if (fleet_.Layout().Parameter(fleet_.Shared()[own[j]]).positive)
            change.positive.push_back(int(j));
        }
        logs.push_back(LogEvidence(change));
      }
      added.push_back({{e, first}, LogSumExp(logs) - std::log(double(logs.size()))});
    }
  }
  return added;
}

std::vector<Eigen::VectorXd> JointEvidence::Mode(const JointWeighed& weighed) const {
  const Joint joint = Assemble(weighed);
  const Eigen::MatrixXd inverse = Llt(Precision(joint.sums, joint.sd)).Inverse();
  const Eigen::MatrixXd C = joint.sd.asDiagonal() * inverse * joint.sd.asDiagonal();
  const Eigen::VectorXd x = PositiveMode(C * joint.sums.g, C, joint.positive);
  const auto S = Eigen::Index(fleet_.Shared().size());
  std::vector<Eigen::VectorXd> theta(fleet_.Size());
  tbb::parallel_for(std::size_t{0}, fleet_.Size(), [&](std::size_t r) {
    const Member& member = fleet_.At(r);
    Eigen::VectorXd shared = x.head(S);
    Eigen::Index at = S;
    for (const Change& change : weighed.hypothesis.changes) {
      const std::vector<int>& own = fleet_.SharedOf(change.effect);
      for (std::size_t j = 0; j < own.size(); ++j, ++at)
        if (int(r) >= change.first) shared[own[j]] += x[at];
    }
    const std::vector<int> out = Out(member);
    theta[r] = Eigen::VectorXd::Zero(member.layout.Size());
    theta[r](fleet_.Shared()) = shared;
    theta[r](out) =
        BestOf(sums_[r], fleet_.Shared(), out, OutSd(member, WideIn(r, weighed)), shared);
  });
  return theta;
}

double JointEvidence::Merit(const JointWeighed& weighed,
                            const std::vector<Eigen::VectorXd>& theta) const {
  const Joint joint = Assemble(weighed);
  const auto S = Eigen::Index(fleet_.Shared().size());
  double merit = 0.0;
  for (std::size_t r = 0; r < fleet_.Size(); ++r) {
    const Member& member = fleet_.At(r);
    const NormalSums& sums = sums_[r];
    merit += sums.c + sums.volume - 2.0 * sums.g.dot(theta[r]) + theta[r].dot(sums.H * theta[r]);
    const Eigen::VectorXd own = theta[r](Out(member));
    merit += own.cwiseQuotient(OutSd(member, WideIn(r, weighed))).squaredNorm();
  }
  const Eigen::VectorXd shared = theta[0](fleet_.Shared());
  merit += shared.cwiseQuotient(joint.sd.head(S)).squaredNorm();
  Eigen::Index at = S;
  for (const Change& change : weighed.hypothesis.changes) {
    for (const int s : fleet_.SharedOf(change.effect)) {
      const int j = fleet_.Shared()[s];
      const double step =
          theta[std::size_t(change.first)][j] - theta[std::size_t(change.first) - 1][j];
      merit += std::pow(step / joint.sd[at++], 2);
    }
  }
  return merit;
}

NormalSums JointEvidence::KnownTo(std::size_t r, const JointWeighed& weighed) const {
  const auto S = int(fleet_.Shared().size());
  const JointHypothesis& h = weighed.hypothesis;
  std::set<std::size_t> firsts{fleet_.Size()};
  for (const Change& change : h.changes) firsts.insert(std::size_t(change.first));
  NormalSums others(S);
  std::size_t begin = 0;
  for (const std::size_t end : firsts) {  // stretches with the same effects
    NormalSums part = Range(WideIn(begin, weighed), begin, end);
    if (r >= begin && r < end) part.Add(Reduced(r, WideIn(r, weighed)), -1.0);
    std::vector<int> kept, out;
    std::set<int> differs;
    for (const Change& change : h.changes)
      if ((int(begin) >= change.first) != (int(r) >= change.first))
        differs.insert(fleet_.SharedOf(change.effect).begin(),
                       fleet_.SharedOf(change.effect).end());
    for (int s = 0; s < S; ++s) (differs.contains(s) ? out : kept).push_back(s);
    const std::vector<int> present = h.EffectsIn(begin);
    const Eigen::VectorXd sd =
        fleet_.Layout().Widened(present, std::vector<double>(present.size(), 1.0))(fleet_.Shared());
    const NormalSums left = IntegratedOut(part, kept, out, sd(out));
    others.H(kept, kept) += left.H;
    others.g(kept) += left.g;
    others.c += left.c;
    others.volume += left.volume;
    begin = end;
  }
  NormalSums known(fleet_.At(r).layout.Size());
  known.H(fleet_.Shared(), fleet_.Shared()) = others.H;
  known.g(fleet_.Shared()) = others.g;
  known.c = others.c;
  known.volume = others.volume;
  return known;
}

}  // namespace flextip::diagnosis
