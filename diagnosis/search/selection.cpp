#include "diagnosis/search/selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/search/hypothesis_fit.h"
#include "diagnosis/search/parameter_scan.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kLeaders = 5;   // fitted from the base simulation
constexpr double kClearly = 60.0;     // log odds, seen from there, that a leader is ahead by
constexpr double kClearlyPart = 0.1;  // or that part of what it gains: the farther, the less linear
constexpr int kFirstRounds = 6;       // of the fit from the base simulation
constexpr int kScans = 3;  // of them, before the second and third of which frequencies are scanned
constexpr int kFitRounds = 4;  // of a fit from where another hypothesis fits
constexpr int kMostFits = 12;
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
    for (const int block : layout_.ScannedBlocks()) ScanAgain(replay_, layout_, block);
    base_ = PlaceOf(replay_);
    basis_ = GenericBasis(replay_);
    LinearProblem base = ProblemHere(replay_, basis_, options_);
    // The same for all hypotheses: what is large in the base's residual may be missed by more.
    may_miss_ = MayMiss(base.residual_size, options_.discrepancy, options_);
    const Rows base_size = tempered_by_ * base.residual_size;
    const Rows at_first = MayMiss(base.residual_size, options_.first_discrepancy, options_);
    const Weighing first = Weigh(replay_, std::move(base),
                                 KnownHypotheses(layout_.EffectCount(), false), options_, at_first);
    FitLeadersFromBase(first);
    FixMeasure(base_size);
    FitRivals();
    FitPartsOfBest();
    if (Unexplained()) {
      int fresh = 0;
      for (const auto& s : first.scored)
        if (Tried(s.weighed.hypothesis) == nullptr && fresh++ < kFreshFits)
          FitFromBase(s.weighed.hypothesis);
      FitRivals();
    }
    WeighAtBest();
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
    if (Tried({}) == nullptr) FitFromBase({});
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
  /// are, and what is fitted is comparable. What was fitted before is not.
  void FixMeasure(const Rows& base_size) {
    if (tempered_by_ != 1.0) {
      SetNoise(1.0);
      replay_.SetAlongPrior(1.0);
      may_miss_ = MayMiss(base_size, options_.discrepancy, options_);
    }
    GoTo(replay_, layout_, best_.place);
    LeaveOutFarSamples();
    replay_.SetNoiseScale(NoiseScale(replay_));
    replay_.FixNoiseModel();
    basis_ = GenericBasis(replay_);
    const Hypothesis leader = best_.hypothesis;
    tried_.clear();
    best_ = {};
    Keep(FitHypothesis(replay_, layout_, leader, options_,
                       {.basis = basis_, .may_miss = may_miss_, .rounds = kFitRounds}));
  }

  void LeaveOutFarSamples() {
    replay_.LeaveOut({});
    const std::vector<std::size_t> far = FarSamples(replay_);
    replay_.LeaveOut(far);
    selection_.far_samples = int(far.size());
  }

  void FitFromBase(const Hypothesis& hypothesis) {
    GoTo(replay_, layout_, base_);
    Keep(FitHypothesis(replay_, layout_, hypothesis, options_,
                       {.basis = basis_,
                        .may_miss = may_miss_,
                        .rounds = kFirstRounds,
                        .scans = kScans,
                        .worth = best_.log_posterior}));
  }

  const HypothesisFit* Tried(const Hypothesis& hypothesis) const {
    for (const auto& fit : tried_)
      if (fit.hypothesis == hypothesis) return &fit;
    return nullptr;
  }

  /// Of several fits of one hypothesis the best counts.
  void Keep(const HypothesisFit& fit) {
    ++selection_.fits;
    const auto before = std::find_if(tried_.begin(), tried_.end(), [&](const HypothesisFit& f) {
      return f.hypothesis == fit.hypothesis;
    });
    if (before == tried_.end()) {
      tried_.push_back(fit);
    } else if (fit.log_posterior > before->log_posterior) {
      *before = fit;
    }
    if (fit.log_posterior > best_.log_posterior) best_ = fit;
  }

  /// Whatever looks better from the best place than the best itself is fitted from there.
  void FitRivals() {
    const auto known = KnownHypotheses(layout_.EffectCount(), true);
    for (rivals_left_ = true; selection_.fits < kMostFits;) {
      GoTo(replay_, layout_, best_.place);
      const Weighing weighing =
          Weigh(replay_, ProblemHere(replay_, basis_, options_), known, options_, may_miss_);
      const ScoredHypothesis* rival = nullptr;
      double log_rival = best_.log_posterior - kRival;
      for (const auto& s : weighing.scored) {
        const double log = s.log_posterior + weighing.log_none + Shortfall(s, weighing);
        if (Tried(s.weighed.hypothesis) != nullptr || log < log_rival) continue;
        rival = &s;
        log_rival = log;
      }
      rivals_left_ = rival != nullptr;
      if (!rivals_left_) return;
      Keep(FitHypothesis(replay_, layout_, rival->weighed.hypothesis, options_,
                         {.basis = basis_,
                          .may_miss = may_miss_,
                          .rounds = kFitRounds,
                          .worth = best_.log_posterior}));
    }
  }

  /// One of a pair may do, or none, with the rest of the world elsewhere than where the best fits.
  /// A part that was fitted and fell short of its promise may have stopped on its way to there.
  void FitPartsOfBest() {
    const Hypothesis whole = best_.hypothesis;
    if (whole.effects.empty()) return;
    const Place place = best_.place;
    GoTo(replay_, layout_, place);
    const Weighing weighing =
        Weigh(replay_, ProblemHere(replay_, basis_, options_),
              KnownHypotheses(layout_.EffectCount(), false), options_, may_miss_);
    for (const auto& s : weighing.scored) {
      const Hypothesis& part = s.weighed.hypothesis;
      const bool is_part = part.effects.size() + 1 == whole.effects.size() &&
                           std::ranges::all_of(part.effects, [&](int effect) {
                             return std::ranges::find(whole.effects, effect) != whole.effects.end();
                           });
      if (!is_part) continue;
      const HypothesisFit* tried = Tried(part);
      if (tried != nullptr && tried->log_posterior > s.log_posterior + weighing.log_none - kRival)
        continue;
      GoTo(replay_, layout_, place);
      Keep(FitHypothesis(replay_, layout_, part, options_,
                         {.basis = basis_,
                          .may_miss = may_miss_,
                          .rounds = kFirstRounds,
                          .worth = best_.log_posterior}));
    }
    FitRivals();
  }

  /// What the fits say of a hypothesis beyond the linear problem about the best place: its own fit,
  /// or the worst of those of its parts, whose broken promise is its promise too.
  double Shortfall(const ScoredHypothesis& s, const Weighing& weighing) const {
    if (const HypothesisFit* own = Tried(s.weighed.hypothesis))
      return own->log_posterior - s.log_posterior - weighing.log_none;
    double worst = 0.0;
    for (const int effect : s.weighed.hypothesis.effects) {
      const HypothesisFit* part = Tried({{effect}, false});
      if (part == nullptr || part->hypothesis == best_.hypothesis) continue;
      for (const auto& single : weighing.scored)
        if (single.weighed.hypothesis == part->hypothesis)
          worst = std::min(worst, part->log_posterior - single.log_posterior - weighing.log_none);
    }
    return worst;
  }

  /// Where something unknown would explain much more, the best may be a wrong turn.
  bool Unexplained() {
    WeighAtBest();
    const auto& best = selection_.Best();
    if (!best.weighed.hypothesis.unknown) return false;
    for (const auto& s : selection_.scored)
      if (s.weighed.hypothesis == best_.hypothesis)
        return best.log_posterior - s.log_posterior > kUnexplained;
    return true;
  }

  /// Everything weighed at the best place; what was fitted counts as it was found to be.
  void WeighAtBest() {
    GoTo(replay_, layout_, best_.place);
    const auto all = AllHypotheses(layout_.EffectCount());
    Weighing weighing = Weigh(replay_, ProblemHere(replay_, basis_, options_),
                              KnownHypotheses(layout_.EffectCount(), true), options_, may_miss_);
    double common = 0.0;  // what the linear problem promises to all
    for (const auto& s : weighing.scored)
      if (s.weighed.hypothesis == best_.hypothesis) common = Shortfall(s, weighing);
    selection_.corrections.clear();
    for (const auto& s : weighing.scored) {
      const bool tried = Tried(s.weighed.hypothesis) != nullptr;
      const double log = Shortfall(s, weighing) - (tried ? common : 0.0);
      if (log != 0.0) selection_.corrections.push_back({s.weighed.hypothesis, log});
    }
    CountMemory(weighing);
    selection_.scored = Score({weighing.problem.total, layout_, weighing.generic_sd},
                              layout_.EffectCount(), all, options_, selection_.corrections);
    selection_.chi2_per_dof = replay_.ChiSquaredPerDof();
    selection_.converged = best_.distance < kNearRest && !rivals_left_;
    selection_.problem = std::move(weighing.problem);
    selection_.generic_sd = std::move(weighing.generic_sd);
  }

  /// Where the best answer's residuals remember themselves, everything that was weighed counts
  /// less.
  void CountMemory(Weighing& weighing) {
    const Evidence evidence(weighing.problem.total, layout_, weighing.generic_sd,
                            {.unknown_sd = {}});
    const WeighedHypothesis best = evidence.Weigh(best_.hypothesis);
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
  Eigen::MatrixXd basis_;
  Rows may_miss_ = Rows::Zero();
  double tempered_by_ = 1.0;  // noise taken over the stated noise, while leaders are fitted
  std::vector<HypothesisFit> tried_;
  HypothesisFit best_;
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
