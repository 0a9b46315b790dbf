#include "diagnosis/prediction/error_sums.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

constexpr int kResamplings = 200;
constexpr int kStrainChannel = 3;

}  // namespace

void ErrorSums::Add(const ErrorSums& other) {
  for (int c = 0; c < kChannelCount; ++c) {
    squares[c] += other.squares[c];
    weighted[c] += other.weighted[c];
    count[c] += other.count[c];
  }
  tip_squares += other.tip_squares;
  tip_distances += other.tip_distances;
  tip_count += other.tip_count;
}

double ErrorSums::Weighted() const {
  double sum = 0.0, n = 0.0;
  for (int c = 0; c < kChannelCount; ++c) {
    sum += weighted[c];
    n += count[c];
  }
  return n > 0.0 ? std::sqrt(sum / n) : 0.0;
}

double ErrorSums::TipRms() const {
  return tip_count > 0.0 ? std::sqrt(tip_squares / tip_count) : 0.0;
}

double ErrorSums::TipMean() const { return tip_count > 0.0 ? tip_distances / tip_count : 0.0; }

ModelScore ErrorSums::Score() const {
  ModelScore score;
  for (int c = 0; c < kChannelCount; ++c)
    if (count[c] > 0.0) {
      // Of the whole vector; gages are no vector.
      const double components = c == kStrainChannel ? 1.0 : kChannels[c].rows;
      score.heldout_rms[kChannels[c].name] = std::sqrt(components * squares[c] / count[c]);
    }
  score.tip_prediction_rms_m = TipRms();
  score.weighted_rms = Weighted();
  return score;
}

TipRows::TipRows(const SampleSet& samples) {
  position = samples.has_tip ? row::kTipPosition : row::kEmPosition;
  for (int r = position; r < position + 5; ++r) hidden.set(r);  // position and direction
}

PredictionErrors::PredictionErrors(const Replay& replay, const TipRows& tip,
                                   const Eigen::VectorXd& dtheta, const SampleRange& range)
    : replay_(replay),
      tip_row_(tip.position),
      free_(replay.ForceFreeResiduals({}, dtheta, range)),
      tip_(replay.ForceFreeResiduals(tip.hidden, dtheta, range)) {
  for (const ReplayedSample& sample : replay.Samples()) judged_.push_back(sample.ok);
}

void PredictionErrors::JudgeOnlyWith(const Replay& other) {
  for (std::size_t k = 0; k < judged_.size(); ++k) judged_[k] = judged_[k] && other.Samples()[k].ok;
}

ErrorSums PredictionErrors::Sum(std::size_t begin, std::size_t end) const {
  ErrorSums sums;
  for (std::size_t k = begin; k < end; ++k) {
    if (!judged_[k]) continue;
    const DiagnosisSample& z = replay_.Set().samples[k];
    const Rows sd = replay_.RowNoise(k);
    for (int c = 0; c < kChannelCount; ++c) {
      for (int r = kChannels[c].first_row; r < kChannels[c].first_row + kChannels[c].rows; ++r) {
        if (!z.present[r]) continue;
        sums.squares[c] += free_[k][r] * free_[k][r];
        sums.weighted[c] += std::pow(free_[k][r] / sd[r], 2);
        sums.count[c] += 1.0;
      }
    }
    if (!z.Has(tip_row_)) continue;
    const auto off = tip_[k].segment<3>(tip_row_);
    sums.tip_squares += off.squaredNorm();
    sums.tip_distances += off.norm();
    sums.tip_count += 1.0;
  }
  return sums;
}

std::pair<double, double> RatioInterval(const std::vector<ErrorSums>& base,
                                        const std::vector<ErrorSums>& extended) {
  std::mt19937_64 rng(7);
  std::uniform_int_distribution<std::size_t> draw(0, base.size() - 1);
  std::vector<double> ratios;
  for (int i = 0; i < kResamplings; ++i) {
    ErrorSums b, e;
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

}  // namespace flextip::diagnosis
