#include "diagnosis/heldout.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr int kResamplings = 200;
constexpr int kStrainChannel = 3;

/// Squares summed over one stretch of time.
struct Sums {
  std::array<double, kChannelCount> squares{}, weighted{}, count{};
  double tip = 0.0, tip_count = 0.0;

  void Add(const Sums& other) {
    for (int c = 0; c < kChannelCount; ++c) {
      squares[c] += other.squares[c];
      weighted[c] += other.weighted[c];
      count[c] += other.count[c];
    }
    tip += other.tip;
    tip_count += other.tip_count;
  }
  double Weighted() const {
    double sum = 0.0, n = 0.0;
    for (int c = 0; c < kChannelCount; ++c) {
      sum += weighted[c];
      n += count[c];
    }
    return n > 0.0 ? std::sqrt(sum / n) : 0.0;
  }
  double Tip() const { return tip_count > 0.0 ? std::sqrt(tip / tip_count) : 0.0; }
};

/// The sensor whose position stands for the tip, and all that is hidden to predict it.
struct TipRows {
  int position = row::kTipPosition;
  std::bitset<row::kCount> hidden;

  explicit TipRows(const SampleSet& samples) {
    position = samples.has_tip ? row::kTipPosition : row::kEmPosition;
    for (int r = position; r < position + 5; ++r) hidden.set(r);  // position and direction
  }
};

/// Errors of one model in samples begin .. end when its parameters move by `dtheta`.
Sums SumStretch(const Replay& replay, const std::vector<Rows>& free, const std::vector<Rows>& tip,
                int tip_row, std::size_t begin, std::size_t end) {
  Sums sums;
  for (std::size_t k = begin; k < end; ++k) {
    if (!replay.Samples()[k].ok) continue;
    const DiagnosisSample& z = replay.Set().samples[k];
    const Rows sd = replay.RowNoise(k);
    for (int c = 0; c < kChannelCount; ++c) {
      for (int r = kChannels[c].first_row; r < kChannels[c].first_row + kChannels[c].rows; ++r) {
        if (!z.present[r]) continue;
        sums.squares[c] += free[k][r] * free[k][r];
        sums.weighted[c] += std::pow(free[k][r] / sd[r], 2);
        sums.count[c] += 1.0;
      }
    }
    if (!z.Has(tip_row)) continue;
    sums.tip += tip[k].segment<3>(tip_row).squaredNorm();
    sums.tip_count += 1.0;
  }
  return sums;
}

ModelScore ScoreOf(const Sums& all, const Replay& replay) {
  ModelScore score;
  for (int c = 0; c < kChannelCount; ++c)
    if (all.count[c] > 0.0) {
      // Of the whole vector; gages are no vector.
      const double components = c == kStrainChannel ? 1.0 : kChannels[c].rows;
      score.heldout_rms[kChannels[c].name] = std::sqrt(components * all.squares[c] / all.count[c]);
    }
  score.tip_prediction_rms_m = all.Tip();
  score.weighted_rms = all.Weighted();
  score.chi2_per_dof = replay.ChiSquaredPerDof();
  return score;
}

/// 5 % and 95 % of the ratio when the stretches are drawn anew.
std::pair<double, double> Interval(const std::vector<Sums>& base,
                                   const std::vector<Sums>& extended) {
  std::mt19937_64 rng(7);
  std::uniform_int_distribution<std::size_t> draw(0, base.size() - 1);
  std::vector<double> ratios;
  for (int i = 0; i < kResamplings; ++i) {
    Sums b, e;
    for (std::size_t j = 0; j < base.size(); ++j) {
      const std::size_t at = draw(rng);
      b.Add(base[at]);
      e.Add(extended[at]);
    }
    if (b.Weighted() > 0.0) ratios.push_back(e.Weighted() / b.Weighted());
  }
  if (ratios.empty()) return {1.0, 1.0};
  std::sort(ratios.begin(), ratios.end());  // by the rank n q, where LowerQuantile has (n - 1) q
  return {ratios[ratios.size() / 20], ratios[ratios.size() * 19 / 20]};
}

NormalSums WithoutFold(const LinearProblem& problem, int fold, int folds) {
  NormalSums train(problem.Size());
  const int blocks = int(problem.blocks.size());
  for (int b = 0; b < blocks; ++b)
    if (b * folds / blocks != fold) train.Add(problem.blocks[b]);
  return train;
}

}  // namespace

Eigen::VectorXd BaseParameters(const NormalSums& sums, const ParameterLayout& layout) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  for (const auto& block : layout.Blocks()) {
    if (!block.nuisance) continue;
    const Eigen::VectorXd sd = layout.Tolerances().segment(block.first, block.size);
    Eigen::MatrixXd M = sd.asDiagonal() *
                        sums.H.block(block.first, block.first, block.size, block.size) *
                        sd.asDiagonal();
    M.diagonal().array() += 1.0;
    const Eigen::VectorXd g = sd.asDiagonal() * sums.g.segment(block.first, block.size);
    theta.segment(block.first, block.size) = sd.asDiagonal() * Llt(M).Solve(g);
  }
  return theta;
}

HeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, int folds) {
  const ParameterLayout& layout = base.Layout();
  const int blocks = int(selection.problem.blocks.size());
  const LinearProblem base_problem = MakeLinearProblem(base, {}, blocks);
  const TipRows tip(base.Set());
  const std::size_t n = base.Samples().size();
  std::vector<Sums> base_sums, extended_sums;
  for (int fold = 0; fold < folds; ++fold) {
    const NormalSums base_train = WithoutFold(base_problem, fold, folds);
    const NormalSums train = WithoutFold(selection.problem, fold, folds);
    const Evidence evidence(train, layout, selection.generic_sd, {.unknown_sd = {}});
    const Eigen::VectorXd base_step = BaseParameters(base_train, layout) - base.Theta();
    const Eigen::VectorXd step =
        evidence.Mode(weighed, evidence.Covariance(weighed)).head(layout.Size()) - extended.Theta();
    const auto base_free = base.ForceFreeResiduals({}, base_step);
    const auto base_tip = base.ForceFreeResiduals(tip.hidden, base_step);
    const auto free = extended.ForceFreeResiduals({}, step);
    const auto free_tip = extended.ForceFreeResiduals(tip.hidden, step);
    for (int b = 0; b < blocks; ++b) {
      if (b * folds / blocks != fold) continue;
      const std::size_t begin = n * b / blocks, end = n * (b + 1) / blocks;
      base_sums.push_back(SumStretch(base, base_free, base_tip, tip.position, begin, end));
      extended_sums.push_back(SumStretch(extended, free, free_tip, tip.position, begin, end));
    }
  }
  Sums b, e;
  for (const Sums& s : base_sums) b.Add(s);
  for (const Sums& s : extended_sums) e.Add(s);
  HeldOut result{ScoreOf(b, base), ScoreOf(e, extended), {}};
  result.gain.measured = b.Weighted() > 0.0;
  if (result.gain.measured) result.gain.heldout_error_ratio = e.Weighted() / b.Weighted();
  if (b.Tip() > 0.0) result.gain.tip_error_ratio = e.Tip() / b.Tip();
  std::tie(result.gain.heldout_error_ratio_low, result.gain.heldout_error_ratio_high) =
      Interval(base_sums, extended_sums);
  return result;
}

}  // namespace flextip::diagnosis
