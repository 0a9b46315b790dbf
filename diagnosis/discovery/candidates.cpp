#include "diagnosis/discovery/candidates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "diagnosis/discovery/library.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kExact = 4;     // of a kind, that are looked at exactly
constexpr std::size_t kRefined = 24;  // kinds
constexpr int kRefinements = 14;
constexpr double kScanned = 15.0;     // twice the log of how many waves were tried
constexpr double kLastResort = 30.0;  // a smooth form must be better than a simple one by so much
/// Half of a range: beyond that nothing is near linear.
constexpr double kMostTolerances = 1000.0;

/// Series of waves in ascending frequency: each from the last by a turn of every sample's phase.
class WaveWalk {
 public:
  TermSeries Next(const Term& wave, const std::vector<TermState>& states) {
    const double by = wave.at[0] - last_;
    if (wave.variable != variable_ || std::abs(by - step_) > 1e-9 * step_ ||
        count_++ % kTurns == 0) {
      const bool near = wave.variable == variable_ && by > 0.0;
      series_ = SeriesOf(wave, states);
      if (near && std::abs(by - step_) > 1e-9 * step_) {
        Term turn = wave;
        turn.at[0] = step_ = by;
        turn_ = SeriesOf(turn, states);
      }
      variable_ = wave.variable;
    } else {  // columns: sines of each input, then cosines
      const Eigen::Index n = series_.cols() / 2;
      const auto s = series_.leftCols(n).array(), c = series_.rightCols(n).array();
      const auto ds = turn_.leftCols(n).array(), dc = turn_.rightCols(n).array();
      TermSeries next(series_.rows(), 2 * n);
      next << s * dc + c * ds, c * dc - s * ds;
      series_ = std::move(next);
    }
    last_ = wave.at[0];
    return series_;
  }

 private:
  static constexpr int kTurns = 200;
  TermSeries series_, turn_;
  TermVariable variable_ = TermVariable::kPreviousSamples;
  double last_ = 0.0, step_ = 0.0;
  int count_ = 0;
};

/// Whether neighbouring samples differ as much as in a sine of 28 samples or less: what a noise
/// that is measured from differences could hold.
bool IsFast(const TermSeries& series) {
  constexpr double kLeast = 0.05;
  const Eigen::Index n = series.rows();
  const auto steps = series.bottomRows(n - 1) - series.topRows(n - 1);
  const auto apart = series.rowwise() - series.colwise().mean();
  return steps.squaredNorm() > kLeast * apart.squaredNorm();
}

/// The best of each kind, of one target.
std::vector<Candidate> BestOfKinds(const TargetScan& scan, TermTarget target,
                                   const std::vector<TermState>& states, const SampleSet& set,
                                   bool fast_waves_only) {
  struct Rough {
    Term term;
    double gain;
  };
  std::map<std::pair<TermShape, TermVariable>, std::vector<Rough>> kinds;
  WaveWalk walk;
  for (Term& term : Library(target, states, set)) {
    if (fast_waves_only && term.shape != TermShape::kPeriodic) continue;
    const TermSeries series =
        term.shape == TermShape::kPeriodic ? walk.Next(term, states) : SeriesOf(term, states);
    if (fast_waves_only && !IsFast(series)) continue;
    auto& kind = kinds[{term.shape, term.variable}];
    kind.push_back({std::move(term), 0.0});
    kind.back().gain = scan.LeastGain(kind.back().term, series);
    if (kind.size() < 4 * kExact) continue;
    std::nth_element(kind.begin(), kind.begin() + kExact, kind.end(),
                     [](const Rough& a, const Rough& b) { return a.gain > b.gain; });
    kind.resize(kExact);
  }
  std::vector<Candidate> best;
  for (auto& [name, kind] : kinds) {
    std::stable_sort(kind.begin(), kind.end(),
                     [](const Rough& a, const Rough& b) { return a.gain > b.gain; });
    if (kind.size() > kExact) kind.resize(kExact);
    Candidate top;
    top.gain = -1.0;
    for (Rough& rough : kind) {
      Candidate one{std::move(rough.term)};
      one.gain = scan.Gain(one.term, SeriesOf(one.term, states));
      if (one.gain > top.gain) top = std::move(one);
    }
    top.gain += scan.OffsetGain();
    best.push_back(std::move(top));
  }
  return best;
}

double& Moved(Term& term, std::size_t i, double by) {
  double& value = term.at[i];
  value = IsScale(term, i) ? value * std::exp(by) : value + by;
  return value;
}

/// Moves the shape's parameters, one after the other, to where they explain most; then their
/// deviations by how fast the gain falls on either side.
void Refine(const TargetScan& scan, const std::vector<TermState>& states, double variance,
            Candidate& candidate) {
  const std::size_t n = candidate.term.at.size();
  std::vector<double> step(n);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    step[i] = StepOf(candidate.term, i, states);
    any |= step[i] > 0.0;
  }
  candidate.at_sd.assign(n, 0.0);
  if (!any) return;
  const double offset = scan.OffsetGain();
  const auto gain_of = [&](Term& term) { return offset + scan.Gain(term, SeriesOf(term, states)); };
  for (int round = 0; round < kRefinements; ++round) {
    bool moved = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (step[i] == 0.0) continue;
      for (const double sign : {1.0, -1.0}) {
        Candidate other{candidate.term};
        Moved(other.term, i, sign * step[i]);
        other.gain = gain_of(other.term);
        if (!(other.gain > candidate.gain)) continue;
        candidate.term = std::move(other.term);
        candidate.gain = other.gain;
        moved = true;
        break;
      }
    }
    if (moved) continue;
    for (double& s : step) s *= 0.4;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double h = 0.3 * StepOf(candidate.term, i, states);
    if (h <= 0.0) continue;
    Term above = candidate.term, below = candidate.term;
    const double wide = 0.5 * std::abs(Moved(above, i, h) - Moved(below, i, -h));
    const double fall = candidate.gain - 0.5 * (gain_of(above) + gain_of(below));
    candidate.at_sd[i] = wide * std::sqrt(variance / std::max(fall, 1e-3 * variance));
  }
}

}  // namespace

double VarianceLeft(const WeightedProblem& weighted, double gain) {
  return std::max(1.0, (weighted.cost - gain) / std::max(1.0, weighted.rows));
}

double Criterion(const Candidate& candidate, double variance, double samples) {
  const Term& term = candidate.term;
  int numbers = int(term.Inputs() * (term.Columns() + 1));
  for (std::size_t i = 0; i < term.at.size(); ++i)
    if (term.shape != TermShape::kLinear && term.shape != TermShape::kQuadratic &&
        term.shape != TermShape::kSmooth && !(term.shape == TermShape::kStep && i == 1))
      ++numbers;
  double complexity = numbers * std::log(samples);
  if (term.shape == TermShape::kPeriodic) complexity += kScanned;
  if (term.shape == TermShape::kSmooth) complexity += kLastResort;
  return candidate.gain / variance - complexity;
}

std::vector<Candidate> FindCandidates(const WeightedProblem& weighted, const StatesByTarget& states,
                                      bool fast_waves_only) {
  std::vector<TermTarget> targets;
  for (const auto& [target, of_target] : states) targets.push_back(target);
  std::vector<std::unique_ptr<TargetScan>> scans(targets.size());
  std::vector<std::vector<Candidate>> by_target(targets.size());
  tbb::parallel_for(std::size_t{0}, targets.size(), [&](std::size_t i) {
    scans[i] = std::make_unique<TargetScan>(weighted, targets[i]);
    by_target[i] = BestOfKinds(*scans[i], targets[i], states.at(targets[i]),
                               weighted.problem.Of().Set(), fast_waves_only);
  });
  std::vector<Candidate> all;
  for (auto& some : by_target)
    all.insert(all.end(), std::make_move_iterator(some.begin()),
               std::make_move_iterator(some.end()));
  const auto rank = [&] {
    double best = 0.0;
    for (const Candidate& one : all) best = std::max(best, one.gain);
    const double variance = VarianceLeft(weighted, best);
    for (Candidate& one : all) one.criterion = Criterion(one, variance, weighted.samples);
    std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
      return a.criterion > b.criterion;
    });
    return variance;
  };
  const double variance = rank();
  tbb::parallel_for(std::size_t{0}, std::min(all.size(), kRefined), [&](std::size_t i) {
    const auto at = std::find(targets.begin(), targets.end(), all[i].term.target) - targets.begin();
    Refine(*scans[static_cast<std::size_t>(at)], states.at(all[i].term.target), variance, all[i]);
  });
  rank();
  if (all.size() > kRefined) all.resize(kRefined);
  std::erase_if(all, [&](const Candidate& one) {
    return HalfRange(one.term, states.at(one.term.target)) > kMostTolerances;
  });
  return all;
}

double HalfRange(const Term& term, const std::vector<TermState>& states) {
  const double tolerance = InfoOf(term.target).tolerance;
  if (term.shape == TermShape::kConstant) return term.offset.norm() / tolerance;
  const TermSeries series = SeriesOf(term, states);
  const Eigen::Index n = term.Inputs();
  Eigen::VectorXd half(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd by = Eigen::VectorXd::Zero(series.rows());
    for (Eigen::Index j = 0; j < term.Columns(); ++j)
      by += term.amplitude(i, j) * series.col(term.IsByInput() ? j * n + i : j);
    std::sort(by.begin(), by.end());
    const auto last = double(by.size() - 1);
    half[i] = 0.5 * (by[Eigen::Index(0.99 * last)] - by[Eigen::Index(0.01 * last)]);
  }
  return half.norm() / tolerance;
}

}  // namespace flextip::diagnosis
