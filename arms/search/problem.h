// The replay's residuals as a linear problem in all parameters and in smooth terms of what the
// joints do, block of time by block of time.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "arms/replay/replay.h"
#include "arms/search/noise.h"
#include "diagnosis/evidence/normal_sums.h"

namespace flextip::arms {

/// Smooth functions of time, joints and speeds at a channel's rows: mean square about one over all
/// recordings. What a right form may miss, and what something unknown may look like.
class Basis {
 public:
  explicit Basis(const Replay& replay);
  /// Rows x functions, of channel `i`.
  const Eigen::MatrixXd& Of(std::size_t i) const { return values_[i]; }
  int Functions() const { return functions_; }
  /// The same without the function of time.
  auto OfJoints(std::size_t i) const { return values_[i].rightCols(functions_ - 1); }

 private:
  std::vector<Eigen::MatrixXd> values_;
  int functions_ = 0;
};

struct ProblemBlock {
  int recording = 0, place = 0;  ///< which stretch of it
  diagnosis::NormalSums sums;
};

struct Problem {
  std::vector<ProblemBlock> blocks;
  diagnosis::NormalSums total;
  int parameters = 0, generics = 0;
};

/// Root mean square of each component of each channel: the size of what is to be explained.
std::vector<Eigen::VectorXd> SizesOf(const Replay& replay, const Noise& noise);

/// `sizes`: units of the smooth terms. Each recording is parted into `parts` stretches.
Problem MakeProblem(const Replay& replay, const Noise& noise, const Basis& basis,
                    const std::vector<Eigen::VectorXd>& sizes, int parts);

/// The stretch of a channel's row.
inline int PartOf(Eigen::Index row, Eigen::Index rows, int parts) {
  return int(row * parts / std::max<Eigen::Index>(1, rows));
}

/// The place among the smooth terms of the first function of a component.
int FirstGeneric(const Replay& replay, const Basis& basis, Kind kind, int component);
int GenericCount(const Replay& replay, const Basis& basis);

}  // namespace flextip::arms
