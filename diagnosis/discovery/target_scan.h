// How much of a residual terms of one target explain, many of them one after the other.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "core/linear_algebra.h"
#include "diagnosis/discovery/residual_problem.h"

namespace flextip::diagnosis {

/// A residual problem with a weight for each block of time: 0 left out, 2 counted twice.
struct WeightedProblem {
  const ResidualProblem& problem;
  std::vector<double> weight;   ///< by block
  Eigen::MatrixXd information;  ///< of the model's parameters, in prior deviations
  Eigen::VectorXd right;        ///< X' z
  double cost = 0.0;            ///< what the model leaves: least squares with its priors
  double rows = 0.0, samples = 0.0;

  WeightedProblem(const ResidualProblem& residual, std::vector<double> weights);
};

class TargetScan {
 public:
  /// `offset`: the target may also be off by a constant. `weighted` must outlive it.
  TargetScan(const WeightedProblem& weighted, TermTarget target, bool offset = true);

  /// What the offset alone takes off the cost.
  double OffsetGain() const { return weighted_.cost - cost_; }
  /// At least so much a term takes off the cost beside the offset.
  double LeastGain(const Term& term, const TermSeries& series) const;
  /// So much, exactly; writes the term's amplitudes and offset.
  double Gain(Term& term, const TermSeries& series) const;

 private:
  struct Normal {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
  };
  Normal NormalOf(const Term& term, const TermSeries& series) const;

  const WeightedProblem& weighted_;
  Eigen::Index inputs_;
  bool offset_;
  double cost_ = 0.0;
  Eigen::VectorXd offset_scale_, right_;
  std::unique_ptr<Llt<Eigen::Dynamic>> llt_;
  Eigen::MatrixXd with_left_, with_self_;  ///< a row a sample
  std::vector<Eigen::MatrixXd> with_X_;    ///< by input, parameters x samples
};

}  // namespace flextip::diagnosis
