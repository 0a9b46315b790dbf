// The hypotheses that a recording leaves in the lead, and how sure the right one of them will be
// once further data are there.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

/// A hypothesis in the lead, with what its parameters then are.
struct Rival {
  Hypothesis hypothesis;
  Eigen::VectorXd theta;  ///< most likely; the layout's parameters
};

class Rivals {
 public:
  /// The rivals are the hypotheses of the catalogue at least a fifth as likely as the best, and
  /// those in which an effect of `groups` stands in the place of the group's first: six at most.
  /// The thirty likeliest stand against them. The references must outlive the object.
  Rivals(const Selection& selection, const ParameterLayout& layout,
         const std::vector<std::vector<int>>& groups);

  const std::vector<Rival>& All() const { return rivals_; }

  /// How sure the rival will be that is the least sure.
  struct LeastSure {
    double log_odds = 1e300;  ///< against all else
    std::size_t rival = 0;
  };
  /// Each rival in turn is taken as right: that its effects act, alone or beside one that is no
  /// rival, since a second effect that hardly shows can never be ruled out. The recording goes on
  /// with data of normal matrix `H` (the layout's parameters, noise of unit covariance).
  LeastSure LeastSureWith(const Eigen::MatrixXd& H) const;

 private:
  bool IsRight(std::size_t rival, std::size_t contender) const;
  std::vector<double> LogPosteriors(const NormalSums& sums) const;

  const Selection& selection_;
  const ParameterLayout& layout_;
  NormalSums known_;  // of the recording, with the generic terms integrated out
  std::vector<Hypothesis> contenders_;
  std::vector<Rival> rivals_;  // the first contenders
};

}  // namespace flextip::diagnosis
