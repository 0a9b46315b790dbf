#include "arms/search/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "arms/search/misfit.h"
#include "arms/search/nuisances.h"
#include "arms/search/windows.h"

namespace flextip::arms {
namespace {

using diagnosis::Evidence;
using diagnosis::EvidenceOptions;
using diagnosis::Hypothesis;
using diagnosis::WeighedHypothesis;

constexpr double kRival = 3.0;          // log odds below the best that are worth a fit
constexpr double kMuchLeft = 4.0;       // chi-squared per row, in stated noise
constexpr double kHardlyCounts = 0.02;  // of what is left
constexpr double kAsSprings = 0.05;     // the same beside springs, whose fits vary by 0.02
constexpr int kMostDrops = 3;
constexpr int kMostFits = 14;  // a round
constexpr int kFitRounds = 6;
constexpr int kCarryRounds = 12;
constexpr double kWorthCarrying = 0.98;  // of the squares that are left without it
constexpr double kShorter = 0.7;         // of the last step: a fit that comes nearer
constexpr int kNoiseRounds = 3;
const std::vector<double> kScales{0.3, 3.0};

/// Where a hypothesis fits.
struct Place {
  Hypothesis hypothesis;
  Eigen::VectorXd theta;
  PlayHistory history;
  double log_posterior = -1e300;
};

class Searcher {
 public:
  Searcher(Replay& replay, Layout& layout, const SearchOptions& options)
      : replay_(replay), layout_(layout), windows_(replay, layout), options_(options) {}

  Found Run() {
    windows_.Set({});
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    replay_.Register();
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    noise_ = MeasureNoise(replay_, false);
    FitNuisances(replay_, noise_);
    found_.base_theta = replay_.Theta();
    // A jerk of some rows would lead all fits by stated noise astray.
    noise_ = MeasureNoise(replay_, true);
    basis_.emplace(replay_);
    sizes_ = SizesOf(replay_, noise_);
    generic_sd_ = Eigen::VectorXd::Constant(GenericCount(replay_, *basis_), options_.discrepancy);
    FitAll();
    Hypothesis last;
    for (int round = 0; round < kNoiseRounds; ++round) {
      tried_.clear();
      Round();
      GoTo(best_);
      const Noise now = MeasureNoise(replay_, true);
      const bool same = round > 0 && best_.hypothesis == last;
      last = best_.hypothesis;
      noise_ = now;
      found_.converged = same;
      if (same) break;
    }
    for (int round = 0; round < kMostDrops && ForbidWhatHardlyCounts(); ++round) {
      tried_.clear();
      Round();
      GoTo(best_);
      noise_ = MeasureNoise(replay_, true);
    }
    Finish();
    return std::move(found_);
  }

 private:
  Evidence EvidenceHere(const Problem& problem, bool unknown) const {
    EvidenceOptions own{.scales = kScales, .unknown_sd = {}};
    if (unknown) own.unknown_sd = {0.1, 0.3, 1.0};
    return Evidence(problem.total, layout_.Prior(), generic_sd_, own);
  }
  Problem ProblemHere() const {
    return MakeProblem(replay_, noise_, *basis_, sizes_, options_.parts);
  }

  void GoTo(const Place& place) {
    windows_.Set(place.history);
    replay_.Evaluate(place.theta);
  }

  /// Everything at once, for the noise that no answer could take away.
  void FitAll() {
    Hypothesis all;
    for (int b = 0; b < layout_.EffectCount(); ++b) all.effects.push_back(b);
    // What the base leaves is no noise: the first fit takes it as stated.
    for (ChannelNoise& noise : noise_) noise.sd = noise.floor;
    for (int round = 0; round < 2; ++round) {
      Descend(all, 3);
      windows_.Scan(noise_);
      Descend(all, 2);
      noise_ = MeasureNoise(replay_, true);
    }
    best_ = {all, replay_.Theta(), windows_.History(), -1e300};
  }

  /// Moves the replay to where `hypothesis` fits.
  WeighedHypothesis Descend(const Hypothesis& hypothesis, int rounds) {
    WeighedHypothesis weighed{hypothesis, 0.0, std::vector<double>(hypothesis.effects.size(), 3.0),
                              0.0};
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < rounds; ++round) {
      const Problem problem = ProblemHere();
      const Evidence evidence = EvidenceHere(problem, false);
      if (hypothesis.effects.size() <= std::size_t(options_.most_effects))
        weighed = evidence.Weigh(hypothesis);
      const Eigen::MatrixXd covariance = evidence.Covariance(weighed);
      const Eigen::VectorXd mode = layout_.WithinBounds(
          replay_.Theta(), evidence.Mode(weighed, covariance).head(layout_.Size()));
      const Eigen::VectorXd sd =
          covariance.diagonal().head(layout_.Size()).cwiseMax(1e-300).cwiseSqrt();
      Eigen::VectorXd step = mode - replay_.Theta();
      // Plays have corners: about them full steps would go to and fro.
      const double length = step.cwiseQuotient(sd).norm();
      if (length > kShorter * last) step *= 0.5;
      last = length;
      replay_.Evaluate(replay_.Theta() + step);
      if (step.cwiseQuotient(sd).norm() < 0.1) break;
    }
    return weighed;
  }

  const Place* Tried(const Hypothesis& hypothesis) const {
    for (const Place& place : tried_)
      if (place.hypothesis == hypothesis) return &place;
    return nullptr;
  }

  /// Where the replay is, as a place of the hypothesis.
  Place PlaceHere(const Hypothesis& hypothesis) const {
    const Problem problem = ProblemHere();
    const Evidence evidence = EvidenceHere(problem, false);
    return {hypothesis, replay_.Theta(), windows_.History(),
            evidence.LogEvidenceOfNone() + evidence.Weigh(hypothesis).log_evidence +
                LogPriorOf(hypothesis, layout_.EffectCount(), options_)};
  }

  bool HasPlay(const Hypothesis& hypothesis) const {
    return windows_.IsThere() && std::find(hypothesis.effects.begin(), hypothesis.effects.end(),
                                           layout_.WindowBlock()) != hypothesis.effects.end();
  }

  /// Plays with windows of their own; and plays that drag each other, from there and from where the
  /// best has such ones. The simpler one unless another leaves less.
  Place FitPlay(const Hypothesis& hypothesis, const Place& from) {
    GoTo(from);
    windows_.LetGo();
    replay_.Evaluate(layout_.InTheMiddle(replay_.Theta()));
    Descend(hypothesis, 2);
    windows_.Scan(noise_);
    Descend(hypothesis, kFitRounds);
    Place place = PlaceHere(hypothesis);
    double least = kWorthCarrying * Misfit();
    const auto descend_carried = [&] {
      Descend(hypothesis, kCarryRounds);
      if (Misfit() >= least) return;
      least = Misfit();
      place = PlaceHere(hypothesis);
    };
    if (windows_.Carry()) descend_carried();
    if (from.history.by_parameters) {
      GoTo(from);
      descend_carried();
    }
    return place;
  }

  /// Fits a hypothesis from where the best is, and keeps where that leads.
  void Fit(const Hypothesis& hypothesis, const Place& from) {
    Place place;
    if (HasPlay(hypothesis)) {
      place = FitPlay(hypothesis, from);
    } else {
      GoTo(from);
      Descend(hypothesis, kFitRounds);
      place = PlaceHere(hypothesis);
    }
    ++found_.fits;
    tried_.push_back(place);
    if (place.log_posterior > best_.log_posterior) best_ = place;
  }

  /// With the noise as it is: fits what looks likely until nothing unfitted looks better.
  void Round() {
    Place from = best_;
    best_.log_posterior = -1e300;
    for (int fits = 0; fits < kMostFits;) {
      GoTo(from);
      const Problem problem = ProblemHere();
      const Evidence evidence = EvidenceHere(problem, false);
      const double none = evidence.LogEvidenceOfNone();
      const auto scored = ScoreHypotheses(evidence, layout_, options_, forbidden_, false);
      int fitted = 0;
      for (const Scored& s : scored) {
        if (fitted >= 3 || s.log_posterior + none < best_.log_posterior - kRival) break;
        if (Tried(s.weighed.hypothesis) != nullptr) continue;
        if (fitted > 0 && s.log_posterior < scored.front().log_posterior - kRival) break;
        Fit(s.weighed.hypothesis, from);
        ++fitted;
        ++fits;
      }
      if (fitted == 0) return;
      from = best_;
    }
  }

  double Misfit() const {
    return SquaresAfter(replay_, noise_, Eigen::VectorXd::Zero(layout_.Size()));
  }

  /// By how much of what is left the misfit rises without each effect of the best, with all that
  /// recordings have of it; or how much of that another of them would have to take over.
  std::vector<double> Importance() {
    GoTo(best_);
    const Problem problem = ProblemHere();
    const Evidence evidence = EvidenceHere(problem, false);
    const double left = Misfit();
    std::vector<double> importance;
    for (const int effect : best_.hypothesis.effects) {
      Hypothesis without;
      const std::string name = layout_.Blocks()[effect].effect->Name();
      for (const int other : best_.hypothesis.effects)
        if (layout_.Blocks()[other].effect->Name() != name) without.effects.push_back(other);
      const WeighedHypothesis weighed = evidence.Weigh(without);
      const Eigen::VectorXd mode =
          evidence.Mode(weighed, evidence.Covariance(weighed)).head(layout_.Size());
      const Eigen::VectorXd step = mode - replay_.Theta();
      double added = SquaresAfter(replay_, noise_, step) - left;
      for (const int other : without.effects) {
        const Layout::Block& block = layout_.Blocks()[other];
        Eigen::VectorXd taken = Eigen::VectorXd::Zero(step.size());
        taken.segment(block.first, block.size) = step.segment(block.first, block.size);
        added = std::max(added, SquaresOf(replay_, noise_, taken));
      }
      importance.push_back(added / std::max(1e-300, left));
    }
    long count = 0;
    for (const ChannelNoise& noise : noise_) count += noise.keep.count();
    left_per_row_ = left / double(std::max(1L, count));
    return importance;
  }

  /// Whether the best has the same effect in other recordings: one may take up the other.
  bool HasTwin(int effect) const {
    const std::string name = layout_.Blocks()[effect].effect->Name();
    return std::any_of(best_.hypothesis.effects.begin(), best_.hypothesis.effects.end(),
                       [&](int other) {
                         return other != effect && layout_.Blocks()[other].effect->Name() == name;
                       });
  }

  /// The same of one effect that springs in plays look like: all others are fitted again, as what
  /// these take up is not linear.
  double ImportanceByFit(int effect) {
    GoTo(best_);
    const double left = Misfit();
    Hypothesis without = best_.hypothesis;
    std::erase(without.effects, effect);
    GoTo(FitPlay(without, best_));
    return Misfit() / std::max(1e-300, left) - 1.0;
  }

  /// Where much is left that nothing explains, an effect that takes away a hundredth of it is not
  /// claimed: any smooth form would. Returns whether there was one.
  bool ForbidWhatHardlyCounts() {
    // What hangs on a link or drives a joint has a form of its own; places of joints do not.
    for (const Channel& channel : replay_.Channels())
      if (channel.kind == Kind::kTorque || channel.kind == Kind::kFollowed) return false;
    std::vector<double> importance = Importance();
    if (left_per_row_ < kMuchLeft) return false;
    int least = -1;
    for (int i = 0; i < int(importance.size()); ++i) {
      const int effect = best_.hypothesis.effects[i];
      if (HasTwin(effect)) continue;
      const bool as_springs =
          best_.history.by_parameters && layout_.Blocks()[effect].effect->IsLikeSprings();
      if (as_springs) importance[i] = ImportanceByFit(effect);
      if (importance[i] < (as_springs ? kAsSprings : kHardlyCounts) &&
          (least < 0 || importance[i] < importance[least]))
        least = i;
    }
    if (least < 0) return false;
    const int block = best_.hypothesis.effects[least];
    forbidden_.insert(block);
    found_.not_claimed.push_back(block);
    std::erase(best_.hypothesis.effects, block);
    return true;
  }

  void Finish() {
    found_.importance.clear();
    const std::vector<double> importance = Importance();
    for (std::size_t i = 0; i < importance.size(); ++i)
      found_.importance[best_.hypothesis.effects[i]] = importance[i];
    GoTo(best_);
    found_.problem = ProblemHere();
    const Evidence evidence = EvidenceHere(found_.problem, true);
    found_.scored = ScoreHypotheses(evidence, layout_, options_, forbidden_, true);
    // What own fits said beyond the linear problem, less what that promised to the best.
    const auto linear = [&](const Hypothesis& hypothesis) {
      for (const Scored& s : found_.scored)
        if (s.weighed.hypothesis == hypothesis) return s.log_posterior;
      return -1e300;
    };
    const double best_linear = linear(best_.hypothesis);
    for (Scored& s : found_.scored) {
      const Place* tried = Tried(s.weighed.hypothesis);
      if (tried == nullptr || s.weighed.hypothesis == best_.hypothesis) continue;
      const double own = tried->log_posterior - best_.log_posterior;
      s.correction = std::min(0.0, own) - (s.log_posterior - best_linear);
      // An own fit that found more than the linear problem promised counts, one that found less
      // too.
      s.log_posterior += s.correction;
    }
    std::stable_sort(found_.scored.begin(), found_.scored.end(), IsBetter);
    found_.generic_sd = generic_sd_;
    found_.noise = noise_;
    found_.sizes = sizes_;
  }

  Replay& replay_;
  Layout& layout_;
  WindowSearch windows_;
  const SearchOptions& options_;
  std::optional<Basis> basis_;
  Noise noise_;
  std::vector<Eigen::VectorXd> sizes_;
  Eigen::VectorXd generic_sd_;
  std::vector<Place> tried_;
  Place best_;
  std::set<int> forbidden_;
  double left_per_row_ = 0.0;
  Found found_;
};

}  // namespace

Found Search(Replay& replay, Layout& layout, const SearchOptions& options) {
  return Searcher(replay, layout, options).Run();
}

const Scored& Found::BestKnown() const {
  for (const Scored& s : scored)
    if (!s.weighed.hypothesis.unknown) return s;
  return scored.front();
}

}  // namespace flextip::arms
