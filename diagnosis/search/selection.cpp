#include "diagnosis/search/selection.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/search/hypothesis_fit.h"
#include "diagnosis/search/parameter_scan.h"
#include "diagnosis/search/tried_fits.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kLeaders = 5;   // fitted from the base simulation
constexpr double kClearly = 60.0;     // log odds, seen from there, that a leader is ahead by
constexpr double kClearlyPart = 0.1;  // or that part of what it gains: the farther, the less linear
constexpr int kFirstRounds = 6;       // of the fit from the base simulation
constexpr int kScans = 3;  // of them, before the second and third of which frequencies are scanned
constexpr int kFitRounds = 4;         // of a fit from where another hypothesis fits
constexpr double kNearLeader = 10.0;  // log odds behind the best leader that may still be right
constexpr int kMostFits = 14;
constexpr int kFitsAnEffect = 4;        // beyond the first one of the best
constexpr int kFreshFits = 6;           // from the base, where nothing explains the recording
constexpr double kRival = 2.0;          // log odds below the best that are worth a fit
constexpr double kNearRest = 3.0;       // distance, in standard deviations
constexpr double kFarMisfit = 6.0;      // of a sample's rows, in standard deviations
constexpr double kTemperedAlong = 0.3;  // of a force along the shaft, in units of EI / L^2
constexpr double kUnexplained = 10.0;   // log odds of something unknown

class Search {
 public:
  Search(Replay& replay, ParameterLayout& layout, const SelectionOptions& options)
      : replay_(replay), layout_(layout), options_(options) {}

  Selection Run() {
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    LeaveOutFarSamples();
    Temper();
    if (tempered_by_ == 1.0) replay_.FixNoiseModel();
    ScanAgain(replay_, layout_, layout_.ScannedBlocks(), layout_.Tolerances());
    base_ = PlaceOf(replay_);
    base_state_ = replay_.Save();
    basis_ = GenericBasis(replay_);
    LinearProblem base = ProblemHere(replay_, basis_, options_);
    // The same for all hypotheses: what is large in the base's residual may be missed by more.
    may_miss_ = MayMiss(base.residual_size, options_.discrepancy, options_);
    const Rows base_size = tempered_by_ * base.residual_size;
    const Rows at_first = MayMiss(base.residual_size, options_.first_discrepancy, options_);
    const Weighing first = Weigh(replay_, std::move(base),
                                 KnownHypotheses(layout_.EffectCount(), 1), options_, at_first);
    FitLeadersFromBase(first);
    base_state_.reset();
    FixMeasure(base_size);
    FitRivals();
    FitPartsOfBest();
    if (Unexplained()) {
      int fresh = 0;
      for (const auto& s : first.scored)
        if (tried_.Find(s.weighed.hypothesis) == nullptr && fresh++ < kFreshFits)
          FitFromBase(s.weighed.hypothesis);
      FitRivals();
    }
    WeighAtBest();
    selection_.fits = tried_.Count();
    return std::move(selection_);
  }

 private:
  /// The base is far from any answer: a few that look best from there are followed.
  void FitLeadersFromBase(const Weighing& first) {
    const double best = first.scored[0].log_posterior;
    double gain = 0.0;
    for (const auto& s : first.scored)
      if (s.weighed.hypothesis == Hypothesis{}) gain = best - s.log_posterior;
    const double clearly = std::max(kClearly, kClearlyPart * gain);
    for (std::size_t i = 0; i < kLeaders && i < first.scored.size(); ++i)
      if (first.scored[i].log_posterior > best - clearly)
        FitFromBase(first.scored[i].weighed.hypothesis);
    if (tried_.Find({}) == nullptr) FitFromBase({});
  }

  /// Far from any answer an unknown force takes up what it can of the misfit, most of it by pulling
  /// the shaft straight, and nothing can be seen from there. The noise is then taken as large as
  /// the misfit, and hardly any force along the shaft as likely, until the leaders are fitted.
  void Temper() {
    const double misfit = MedianMisfit(replay_);
    if (replay_.Set().has_load || misfit < kFarMisfit) return;
    tempered_by_ = misfit;
    SetNoise(misfit);
    replay_.SetAlongPrior(kTemperedAlong);
    replay_.SetForces(
        std::vector<Eigen::Vector3d>(replay_.Samples().size(), Eigen::Vector3d::Zero().eval()));
    replay_.Evaluate(Eigen::VectorXd::Zero(layout_.Size()));
    LeaveOutFarSamples();
  }

  void SetNoise(double scale) {
    std::array<double, kChannelCount> scales;
    scales.fill(scale);
    replay_.SetNoiseScale(scales);
  }

  /// Where the best leader fits, noise and forces are known better; from here on they stay as they
  /// are, and what is fitted is comparable. What was fitted before is not: the leaders that came
  /// near the best are fitted again. Seen from the best's place they may look far.
  void FixMeasure(const Rows& base_size) {
    if (tempered_by_ != 1.0) {
      SetNoise(1.0);
      replay_.SetAlongPrior(1.0);
      may_miss_ = MayMiss(base_size, options_.discrepancy, options_);
    }
    // Where none leads, what comes near it is none with something that does not show.
    const double reach = tried_.Best().hypothesis.effects.empty() ? 0.0 : kNearLeader;
    const std::vector<HypothesisFit> near = tried_.Near(reach);
    GoTo(replay_, layout_, tried_.Best().place);
    LeaveOutFarSamples();
    replay_.SetNoiseScale(NoiseScale(replay_));
    replay_.FixNoiseModel();
    basis_ = GenericBasis(replay_);
    tried_.Clear();
    for (const HypothesisFit& leader : near) {
      GoTo(replay_, layout_, leader.place);
      FitFromHere(leader.hypothesis, kFitRounds);
    }
  }

  void LeaveOutFarSamples() {
    replay_.LeaveOut({});
    const std::vector<std::size_t> far = FarSamples(replay_);
    replay_.LeaveOut(far);
    selection_.far_samples = int(far.size());
  }

  /// Until the measure changes, without solving anything.
  void GoToBase() {
    if (!base_state_) return GoTo(replay_, layout_, base_);
    SetScanCentres(layout_, base_.scan_centres);
    replay_.Restore(*base_state_);
  }

  void FitFromBase(const Hypothesis& hypothesis) {
    GoToBase();
    tried_.Keep(FitHypothesis(replay_, layout_, hypothesis, options_,
                              {.basis = basis_,
                               .may_miss = may_miss_,
                               .rounds = kFirstRounds,
                               .scans = kScans,
                               .worth = tried_.Best().log_posterior}));
  }

  /// Weighs all that the catalogue holds from the place of the best fit.
  Weighing WeighKnown() {
    GoTo(replay_, layout_, tried_.Best().place);
    return Weigh(replay_, ProblemHere(replay_, basis_, options_),
                 tried_.WithLarger(KnownHypotheses(layout_.EffectCount(), 2)), options_, may_miss_,
                 true);
  }

  /// Fits `hypothesis` from where the replay stands.
  void FitFromHere(const Hypothesis& hypothesis, int rounds) {
    tried_.Keep(FitHypothesis(replay_, layout_, hypothesis, options_,
                              {.basis = basis_,
                               .may_miss = may_miss_,
                               .rounds = rounds,
                               .worth = tried_.Best().log_posterior}));
  }

  /// More effects at once take more fits to be found one after another.
  bool MayFitMore() const {
    const int more = std::max(0, int(tried_.Best().hypothesis.effects.size()) - 1);
    return tried_.Count() < kMostFits + more * kFitsAnEffect;
  }

  /// Whatever looks better from the best place than the best itself is fitted from there: also what
  /// was fitted from elsewhere and ended where it looks worse, once from each place.
  void FitRivals() {
    std::vector<Hypothesis> from_here;
    Hypothesis here = tried_.Best().hypothesis;
    for (rivals_left_ = true; MayFitMore();) {
      if (tried_.Best().hypothesis != here) from_here.clear();
      here = tried_.Best().hypothesis;
      const Weighing weighing = WeighKnown();
      const ScoredHypothesis* rival = nullptr;
      double log_rival = tried_.Best().log_posterior - kRival;
      for (const auto& s : weighing.scored) {
        const Hypothesis& h = s.weighed.hypothesis;
        double log = s.log_posterior + weighing.log_none;
        if (const HypothesisFit* tried = tried_.Find(h)) {
          const bool was_here = h == here || std::ranges::find(from_here, h) != from_here.end();
          if (was_here || log < tried->log_posterior + kRival) continue;
        } else {
          log += tried_.Shortfall(s, weighing);
        }
        if (log < log_rival) continue;
        rival = &s;
        log_rival = log;
      }
      rivals_left_ = rival != nullptr;
      if (!rivals_left_) return;
      from_here.push_back(rival->weighed.hypothesis);
      FitFromHere(rival->weighed.hypothesis, kFitRounds);
    }
  }

  /// Fewer effects may do, or none, with the rest of the world elsewhere than where the best fits.
  /// A part that was fitted and fell short of its promise may have stopped on its way to there.
  void FitPartsOfBest() {
    const HypothesisFit whole = tried_.Best();
    GoTo(replay_, layout_, whole.place);
    const std::vector<Hypothesis> parts = PartsOf(whole.hypothesis);
    if (parts.empty()) return;
    const Weighing weighing =
        Weigh(replay_, ProblemHere(replay_, basis_, options_), parts, options_, may_miss_);
    for (const auto& s : weighing.scored) {
      const HypothesisFit* tried = tried_.Find(s.weighed.hypothesis);
      if (tried != nullptr && tried->log_posterior > s.log_posterior + weighing.log_none - kRival)
        continue;
      GoTo(replay_, layout_, whole.place);
      FitFromHere(s.weighed.hypothesis, kFirstRounds);
    }
    FitRivals();
  }

  /// Where something unknown would explain much more, the best may be a wrong turn.
  bool Unexplained() {
    WeighAtBest();
    const auto& best = selection_.Best();
    if (!best.weighed.hypothesis.unknown) return false;
    for (const auto& s : selection_.scored)
      if (s.weighed.hypothesis == tried_.Best().hypothesis)
        return best.log_posterior - s.log_posterior > kUnexplained;
    return true;
  }

  /// Everything weighed at the best place; what was fitted counts as it was found to be.
  void WeighAtBest() {
    Weighing weighing = WeighKnown();
    double common = 0.0;  // what the linear problem promises to all
    for (const auto& s : weighing.scored)
      if (s.weighed.hypothesis == tried_.Best().hypothesis) common = tried_.Shortfall(s, weighing);
    selection_.corrections.clear();
    std::vector<Hypothesis> all = AllHypotheses(layout_.EffectCount());
    for (const auto& s : weighing.scored) {
      const bool tried = tried_.Find(s.weighed.hypothesis) != nullptr;
      const double log = tried_.Shortfall(s, weighing) - (tried ? common : 0.0);
      if (log != 0.0) selection_.corrections.push_back({s.weighed.hypothesis, log});
      if (s.weighed.hypothesis.effects.size() > 2) all.push_back(s.weighed.hypothesis);
    }
    CountMemory(weighing);
    selection_.scored = Score({weighing.problem.total, layout_, weighing.generic_sd},
                              layout_.EffectCount(), all, options_, selection_.corrections);
    selection_.chi2_per_dof = replay_.ChiSquaredPerDof();
    selection_.converged = tried_.Best().distance < kNearRest && !rivals_left_;
    selection_.problem = std::move(weighing.problem);
    selection_.generic_sd = std::move(weighing.generic_sd);
  }

  /// Where the best answer's residuals remember themselves, everything that was weighed counts
  /// less.
  void CountMemory(Weighing& weighing) {
    const Evidence evidence(weighing.problem.total, layout_, weighing.generic_sd,
                            {.unknown_sd = {}});
    const WeighedHypothesis best = evidence.Weigh(tried_.Best().hypothesis);
    const Eigen::VectorXd mode = evidence.Mode(best, evidence.Covariance(best));
    selection_.memory = MemoryOfResiduals(replay_, basis_, weighing.problem, mode);
    const double as_one = selection_.memory.SamplesAsOne();
    weighing.problem.CountAsOne(as_one);
    for (Correction& correction : selection_.corrections) correction.log /= as_one;
  }

  Replay& replay_;
  ParameterLayout& layout_;
  const SelectionOptions& options_;
  Place base_;
  std::optional<Replay::State> base_state_;
  Eigen::MatrixXd basis_;
  Rows may_miss_ = Rows::Zero();
  double tempered_by_ = 1.0;  // noise taken over the stated noise, while leaders are fitted
  TriedFits tried_;
  bool rivals_left_ = false;
  Selection selection_;
};

}  // namespace

const WeighedHypothesis& Selection::BestKnown() const {
  for (const auto& s : scored)
    if (!s.weighed.hypothesis.unknown) return s.weighed;
  return scored.front().weighed;
}

Selection Select(Replay& replay, ParameterLayout& layout, const SelectionOptions& options) {
  return Search(replay, layout, options).Run();
}

}  // namespace flextip::diagnosis
