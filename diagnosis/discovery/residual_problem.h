// What an answer leaves of the measurements, and what the answer's model may still take up of a
// term: rows of unit covariance, in blocks of time that can be left out or counted again.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/effects/discovered/term_columns.h"
#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// A shape over the samples: a row a sample, columns of the shape one after the other; of a shape
/// with a variable for each input each column once an input.
using TermSeries = Eigen::MatrixXd;

class ResidualProblem {
 public:
  /// About the point where `replay` stands, the parameters' priors `prior_sd` about the base.
  /// Recordings of many samples are thinned, at random so that nothing fast looks slow.
  ResidualProblem(const Replay& replay, const Eigen::VectorXd& prior_sd, int blocks);

  int Blocks() const { return static_cast<int>(squares_.size()); }
  int SamplesUsed() const { return samples_used_; }
  const Replay& Of() const { return *replay_; }

  /// The whitened rows' derivatives by the target's inputs, in the target's own sign.
  Eigen::MatrixXd ByTarget(TermTarget target) const;
  /// The whitened rows that the series moves: a column an amplitude (inputs first), then `offset`:
  /// one an input.
  Eigen::MatrixXd Moved(const Term& term, const TermSeries& series, bool offset) const;

  /// Lets the model take up the columns freely from now on.
  void Free(const Eigen::MatrixXd& columns);

  /// Of the samples of a block: the first row, and one past the last.
  int FirstRow(int block) const { return first_row_[static_cast<std::size_t>(block)]; }
  const Eigen::MatrixXd& Derivatives() const { return X_; }  ///< in prior deviations
  const Eigen::VectorXd& Left() const { return z_; }         ///< measured less base
  Eigen::VectorXd LeftHere() const { return here_; }         ///< less what the replay stands at
  const Eigen::MatrixXd& Squares(int block) const {
    return squares_[static_cast<std::size_t>(block)];
  }
  /// The measured rows of a sample.
  const std::vector<int>& RowsOf(std::size_t k) const { return rows_.rows[k]; }
  int FirstRowOfSample(std::size_t k) const { return sample_row_[k]; }
  int BlockOf(std::size_t k) const;

 private:
  void SumSquares();

  const Replay* replay_;
  WhitenedRows rows_;
  std::vector<int> sample_row_, first_row_;
  std::vector<std::vector<int>> used_rows_;
  Eigen::MatrixXd X_;
  Eigen::VectorXd z_, here_;
  std::vector<Eigen::MatrixXd> squares_;  ///< X' X by block
  int samples_used_ = 0;
};

/// The states of a target's variables over all samples.
std::vector<TermState> StatesOf(const Replay& replay, TermTarget target);

TermSeries SeriesOf(const Term& term, const std::vector<TermState>& states);

}  // namespace flextip::diagnosis
