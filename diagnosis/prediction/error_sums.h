// Errors of a model's predictions, summed over stretches of time.
#pragma once

#include <array>
#include <bitset>
#include <utility>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Squares summed over one stretch of time.
struct ErrorSums {
  std::array<double, kChannelCount> squares{}, weighted{}, count{};
  double tip_squares = 0.0, tip_distances = 0.0, tip_count = 0.0;

  void Add(const ErrorSums& other);
  /// Root mean square of all channels, in standard deviations of their noise; 0 where none spoke.
  double Weighted() const;
  double TipRms() const;
  double TipMean() const;
  /// Returns the errors of each channel that spoke. `chi2_per_dof` stays zero.
  ModelScore Score() const;
};

/// The sensor whose position stands for the tip, and all that is hidden to predict it.
struct TipRows {
  int position = row::kTipPosition;
  std::bitset<row::kCount> hidden;

  explicit TipRows(const SampleSet& samples);
};

/// Errors of the model at which `replay` stands, its parameters moved by `dtheta` to first order
/// (empty: not). Forces that are not measured are found from each sample's own sensors, for the
/// tip's error without those that measure the tip. Only samples of `range` may be summed.
class PredictionErrors {
 public:
  PredictionErrors(const Replay& replay, const TipRows& tip, const Eigen::VectorXd& dtheta = {},
                   const SampleRange& range = {});

  /// Returns the sums over the samples begin .. end that have an equilibrium.
  ErrorSums Sum(std::size_t begin, std::size_t end) const;
  /// Leaves out of Sum the samples without an equilibrium in `other`.
  void JudgeOnlyWith(const Replay& other);

 private:
  const Replay& replay_;
  int tip_row_;
  std::vector<Rows> free_, tip_;
  std::vector<bool> judged_;
};

/// Returns 5 % and 95 % of the ratio of the weighted errors when the stretches are drawn anew.
std::pair<double, double> RatioInterval(const std::vector<ErrorSums>& base,
                                        const std::vector<ErrorSums>& extended);

}  // namespace flextip::diagnosis
