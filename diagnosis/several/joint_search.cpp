#include "diagnosis/several/joint_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kLeaders = 4;   // fitted from the base simulation
constexpr double kClearly = 60.0;     // log odds, seen from there, that a leader is ahead by
constexpr double kClearlyPart = 0.1;  // or that part of what it gains
constexpr int kFirstRounds = 6, kFitRounds = 4;
constexpr int kMostRounds = 24;       // of the best one: where a play stood is found slowly
constexpr double kNearLeader = 10.0;  // log odds behind the best leader that may still be right
constexpr int kMostFits = 14;
constexpr double kSettled = 1.0;                          // log odds that are still promised
constexpr double kJointlyAtRest = 0.1, kFirstRest = 3.0;  // the same; before noise is measured
constexpr double kRival = 2.0;        // log odds below the best that are worth a fit
constexpr std::size_t kBesides = 10;  // hypotheses beside which changes are weighed, with singles
constexpr std::size_t kFewRecordings = 10;  // own effects are weighed beside all of these
constexpr std::size_t kMostEffects = 2;     // in any recording: three at once are not weighed

std::vector<JointHypothesis> Commons(const Fleet& fleet, bool pairs) {
  std::vector<JointHypothesis> all;
  for (const Hypothesis& h : KnownHypotheses(fleet.EffectCount(), pairs ? 2 : 1))
    all.push_back({h.effects, {}, false});
  return all;
}

void Sort(std::vector<JointScored>& scored) {
  std::ranges::stable_sort(scored, [](const JointScored& a, const JointScored& b) {
    return a.log_posterior > b.log_posterior;
  });
}

std::vector<JointScored> Weighed(const JointEvidence& evidence, const Fleet& fleet,
                                 const std::vector<JointHypothesis>& hypotheses,
                                 const SelectionOptions& options) {
  std::vector<JointScored> scored(hypotheses.size());
  tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    scored[i].weighed = evidence.Weigh(hypotheses[i]);
    scored[i].log_posterior =
        scored[i].weighed.log_evidence + LogPrior(hypotheses[i], fleet, options);
  });
  Sort(scored);
  return scored;
}

/// `beside` and each change that it has not yet; `own_too`: of effects that each recording has for
/// itself, too.
std::vector<JointScored> WithChanges(const JointEvidence& evidence, const Fleet& fleet,
                                     const JointWeighed& beside, bool own_too,
                                     const SelectionOptions& options) {
  std::vector<JointScored> scored;
  if (beside.hypothesis.EffectsIn(fleet.Size() - 1).size() >= kMostEffects) return scored;
  std::vector<JointHypothesis> own;  // of effects that each recording has for itself
  for (const auto& added : evidence.WithChanges(beside)) {
    JointWeighed weighed = beside;
    weighed.hypothesis.changes.push_back(added.change);
    weighed.scales.push_back(1.0);
    weighed.log_evidence += added.log_gain;
    const double log = weighed.log_evidence + LogPrior(weighed.hypothesis, fleet, options);
    scored.push_back({weighed, log});
  }
  for (int e = 0; e < fleet.EffectCount(); ++e) {
    if (fleet.OwnOf(e).empty() || !own_too) continue;
    const std::vector<int> present = beside.hypothesis.EffectsIn(fleet.Size() - 1);
    if (std::ranges::find(present, e) != present.end()) continue;
    for (int first = 1; first < int(fleet.Size()); ++first) {
      own.push_back(beside.hypothesis);
      own.back().changes.push_back({e, first});
    }
  }
  for (JointScored& one : Weighed(evidence, fleet, own, options)) scored.push_back(one);
  return scored;
}

class Search {
 public:
  explicit Search(const MemberWorkers& workers)
      : workers_(workers), fleet_(workers.Members()), options_(workers.Options()) {}

  JointSelection Run() {
    StandAtBase(workers_);
    const JointPlace base = PlaceOf(fleet_);
    FitLeadersFrom(base);
    GoTo(fleet_, best_.place);
    FixMeasure(workers_);
    std::vector<JointHypothesis> near{best_.weighed.hypothesis};
    for (const JointFit& fit : tried_)
      if (fit.log_posterior > best_.log_posterior - kNearLeader &&
          !(fit.weighed.hypothesis == near[0]))
        near.push_back(fit.weighed.hypothesis);
    tried_.clear();
    best_ = {};
    for (const JointHypothesis& leader : near)
      Keep(FitJointly(workers_, leader, kMostRounds, best_.log_posterior, kJointlyAtRest));
    FitRivals();
    FitPartsOfBest();
    GoTo(fleet_, best_.place);
    FindCorrections();
    selection_.best = best_;
    selection_.converged = best_.promised < kSettled && !rivals_left_;
    return std::move(selection_);
  }

 private:
  const JointFit* Tried(const JointHypothesis& h) const {
    for (const JointFit& fit : tried_)
      if (fit.weighed.hypothesis == h) return &fit;
    return nullptr;
  }

  void Keep(JointFit fit) {
    ++selection_.fits;
    if (fit.log_posterior > best_.log_posterior) best_ = fit;
    for (JointFit& before : tried_) {
      if (!(before.weighed.hypothesis == fit.weighed.hypothesis)) continue;
      if (fit.log_posterior > before.log_posterior) before = std::move(fit);
      return;
    }
    fit.place = {};  // only the best one's is needed
    tried_.push_back(std::move(fit));
  }

  /// The base is far from any answer: a few that look best from there are followed.
  void FitLeadersFrom(const JointPlace& base) {
    const JointEvidence evidence = EvidenceHere(fleet_);
    std::vector<JointScored> scored = Weighed(evidence, fleet_, Commons(fleet_, false), options_);
    const auto none = std::ranges::find_if(
        scored, [](const JointScored& s) { return s.weighed.hypothesis == JointHypothesis{}; });
    const JointScored nothing = *none;
    for (JointScored& one : WithChanges(evidence, fleet_, nothing.weighed, true, options_))
      scored.push_back(one);
    Sort(scored);
    const double best = scored.front().log_posterior;
    const double clearly = std::max(kClearly, kClearlyPart * (best - nothing.log_posterior));
    for (std::size_t i = 0; i < kLeaders && i < scored.size(); ++i) {
      if (scored[i].log_posterior < best - clearly) break;
      if (LeadsByItself(scored[i], nothing))
        FitFrom(base, scored[i].weighed.hypothesis, kFirstRest);
    }
    // Where it is clearly behind, `none` is fitted as a part of the best.
    if (nothing.log_posterior > best - clearly && Tried({}) == nullptr)
      FitFrom(base, {}, kFirstRest);
  }

  /// What looks no better than nothing, and a change that begins elsewhere than one that is fitted,
  /// lead where that leads, and are fitted from there.
  bool LeadsByItself(const JointScored& one, const JointScored& nothing) const {
    const JointHypothesis& h = one.weighed.hypothesis;
    if (!(h == JointHypothesis{}) && one.log_posterior < nothing.log_posterior) return false;
    return std::ranges::none_of(tried_, [&](const JointFit& fit) {
      const JointHypothesis& before = fit.weighed.hypothesis;
      return before.effects == h.effects &&
             std::ranges::equal(before.changes, h.changes, {}, &Change::effect, &Change::effect);
    });
  }

  void FitFrom(const JointPlace& place, const JointHypothesis& h, double rest) {
    GoTo(fleet_, place);
    Keep(FitJointly(workers_, h, kFirstRounds, best_.log_posterior, rest));
  }

  /// The best one is fitted until it is at rest: a rival that is fitted from its place would gain
  /// what it has not yet gained itself.
  void Settle() {
    GoTo(fleet_, best_.place);
    if (best_.promised < kSettled || best_.log_posterior == settled_at_) return;
    Keep(FitJointly(workers_, best_.weighed.hypothesis, kMostRounds, best_.log_posterior,
                    kJointlyAtRest));
    settled_at_ = best_.log_posterior;
    GoTo(fleet_, best_.place);
  }

  /// Whatever looks better from the best place than the best itself is fitted from there: also what
  /// was fitted from elsewhere and ended where it looks worse, once from each place.
  void FitRivals() {
    std::vector<JointHypothesis> from_here;
    JointHypothesis here = best_.weighed.hypothesis;
    for (rivals_left_ = true; selection_.fits < kMostFits;) {
      Settle();
      if (!(best_.weighed.hypothesis == here)) from_here.clear();
      here = best_.weighed.hypothesis;
      const auto scored = WeighAll(EvidenceHere(fleet_), fleet_, here, options_);
      // At rest, what the problem still promises to the best is promised to all, and not had.
      double log_rival = best_.log_posterior - kRival;
      for (const JointScored& s : scored)
        if (s.weighed.hypothesis == here) log_rival = std::max(log_rival, s.log_posterior - kRival);
      const JointScored* rival = nullptr;
      for (const JointScored& s : scored) {
        const JointHypothesis& h = s.weighed.hypothesis;
        const JointFit* tried = Tried(h);
        const bool was_here = h == here || std::ranges::find(from_here, h) != from_here.end();
        if (tried && (was_here || s.log_posterior < tried->log_posterior + kRival)) continue;
        const double log = s.log_posterior + (tried ? 0.0 : Shortfall(s, scored));
        if (log < log_rival) continue;
        rival = &s;
        log_rival = log;
      }
      rivals_left_ = rival != nullptr;
      if (!rivals_left_) return;
      from_here.push_back(rival->weighed.hypothesis);
      Keep(FitJointly(workers_, rival->weighed.hypothesis, kFitRounds, best_.log_posterior,
                      kJointlyAtRest));
    }
  }

  /// The best less one of its effects or changes, fitted by itself; again, from here, where it was
  /// not at rest.
  void FitPartsOfBest() {
    const JointHypothesis whole = best_.weighed.hypothesis;
    const JointPlace place = best_.place;
    std::vector<JointHypothesis> parts;
    for (std::size_t i = 0; i < whole.effects.size(); ++i) {
      parts.push_back(whole);
      parts.back().effects.erase(parts.back().effects.begin() + std::ptrdiff_t(i));
    }
    for (std::size_t i = 0; i < whole.changes.size(); ++i) {
      parts.push_back(whole);
      parts.back().changes.erase(parts.back().changes.begin() + std::ptrdiff_t(i));
    }
    for (const JointHypothesis& part : parts) {
      const JointFit* fit = Tried(part);
      if (fit == nullptr || fit->promised >= kSettled) FitFrom(place, part, kJointlyAtRest);
    }
    FitRivals();
  }

  /// What its own fit says of a hypothesis beyond the problem about the best place; the broken
  /// promise of a part is its promise too.
  double Shortfall(const JointScored& s, const std::vector<JointScored>& scored) const {
    if (const JointFit* own = Tried(s.weighed.hypothesis))
      return own->log_posterior - s.log_posterior;
    std::vector<JointHypothesis> parts;
    for (const int effect : s.weighed.hypothesis.effects) parts.push_back({{effect}, {}, false});
    for (const Change& change : s.weighed.hypothesis.changes)
      parts.push_back({{}, {change}, false});
    double worst = 0.0;
    for (const JointHypothesis& part : parts) {
      const JointFit* fit = Tried(part);
      if (fit == nullptr || part == best_.weighed.hypothesis) continue;
      for (const JointScored& single : scored)
        if (single.weighed.hypothesis == part)
          worst = std::min(worst, fit->log_posterior - single.log_posterior);
    }
    return worst;
  }

  void FindCorrections() {
    const auto scored = WeighAll(EvidenceHere(fleet_), fleet_, best_.weighed.hypothesis, options_);
    double common = 0.0;  // what the problem promises to all
    for (const JointScored& s : scored)
      if (s.weighed.hypothesis == best_.weighed.hypothesis) common = Shortfall(s, scored);
    for (const JointScored& s : scored) {
      const bool tried = Tried(s.weighed.hypothesis) != nullptr;
      const double log = Shortfall(s, scored) - (tried ? common : 0.0);
      if (log != 0.0) selection_.corrections.emplace_back(s.weighed.hypothesis, log);
    }
  }

  const MemberWorkers& workers_;
  Fleet& fleet_;
  const SelectionOptions& options_;
  std::vector<JointFit> tried_;
  JointFit best_;
  double settled_at_ = 0.0;  // the best one's log odds when it was fitted last for that
  bool rivals_left_ = false;
  JointSelection selection_;
};

}  // namespace

std::vector<JointScored> WeighAll(const JointEvidence& evidence, const Fleet& fleet,
                                  const JointHypothesis& best, const SelectionOptions& options) {
  std::vector<JointScored> scored = Weighed(evidence, fleet, Commons(fleet, true), options);
  if (fleet.Size() < 2) return scored;
  std::vector<JointWeighed> besides;
  for (std::size_t i = 0; i < scored.size(); ++i)
    if (i < kBesides || scored[i].weighed.hypothesis.effects.size() < 2)
      besides.push_back(scored[i].weighed);
  std::vector<JointScored> more;
  const std::size_t first_of_best = besides.size();
  if (!best.changes.empty()) {
    const JointScored own = Weighed(evidence, fleet, {best}, options).front();
    more.push_back(own);
    besides.push_back(own.weighed);
    JointHypothesis common{best.effects, {}, false};
    const bool is_in =
        std::ranges::any_of(besides, [&](const JointWeighed& w) { return w.hypothesis == common; });
    if (!is_in) besides.push_back(evidence.Weigh(common));
  }
  std::vector<std::vector<JointScored>> with(besides.size());
  tbb::parallel_for(std::size_t{0}, besides.size(), [&](std::size_t i) {
    // Of many recordings these are most of the time: beside the leaders alone.
    const bool leads = i < kBesides || i >= first_of_best;
    with[i] =
        WithChanges(evidence, fleet, besides[i], leads || fleet.Size() <= kFewRecordings, options);
  });
  for (const auto& list : with)
    for (const JointScored& one : list)
      if (!(one.weighed.hypothesis == best)) more.push_back(one);
  scored.insert(scored.end(), more.begin(), more.end());
  Sort(scored);
  return scored;
}

JointSelection SearchJointly(const MemberWorkers& workers) { return Search(workers).Run(); }

}  // namespace flextip::diagnosis
