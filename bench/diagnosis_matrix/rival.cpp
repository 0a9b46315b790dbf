#include "bench/diagnosis_matrix/rival.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/search/hypotheses.h"

namespace flextip::bench {
namespace {

constexpr double kWidth = 3.0;  // of a present effect's prior, in typical sizes

/// Explanations of data without noise.
class Explanations {
 public:
  /// Of the signal z by X^T X, X^T z and z^T z.
  Explanations(const Eigen::MatrixXd& H, Eigen::VectorXd g, double c,
               const diagnosis::ParameterLayout& layout)
      : H_(H), layout_(layout), g_(std::move(g)), c_(c) {}

  /// Least |z - X x|^2 + |x / sd|^2 with the blocks of `present` there. One that would have to be
  /// negative and cannot is no help: the rest is left to explain the data.
  double CostOf(const std::vector<int>& present) const {
    const Eigen::VectorXd sd = WidePrior(layout_, present);
    Eigen::MatrixXd M = sd.asDiagonal() * H_ * sd.asDiagonal();
    M.diagonal().array() += 1.0;
    const Eigen::VectorXd sg = sd.asDiagonal() * g_, x = Llt(M).Solve(sg);
    bool possible = true;
    double without = std::numeric_limits<double>::infinity();
    for (const int b : present) {
      if (!IsNegative(b, x)) continue;
      possible = false;
      std::vector<int> rest = present;
      std::erase(rest, b);
      without = std::min(without, CostOf(rest));
    }
    return possible ? c_ - sg.dot(x) : without;
  }

 private:
  bool IsNegative(int b, const Eigen::VectorXd& x) const {
    const auto& block = layout_.Blocks()[b];
    for (int j = block.first; j < block.first + block.size; ++j)
      if (layout_.Parameter(j).positive && x[j] < 0.0) return true;
    return false;
  }

  const Eigen::MatrixXd& H_;
  const diagnosis::ParameterLayout& layout_;
  Eigen::VectorXd g_;
  double c_ = 0.0;
};

Separation Nearest(const Explanations& explanations,
                   const std::vector<diagnosis::Hypothesis>& rivals, double of_truth,
                   const diagnosis::ParameterLayout& layout) {
  Separation nearest{std::numeric_limits<double>::infinity(), {}};
  std::size_t effects = 0;
  for (const diagnosis::Hypothesis& rival : rivals) {
    if (rival.effects.size() > effects && nearest.value < kSeparable) break;
    effects = rival.effects.size();
    const double value = explanations.CostOf(rival.effects) - of_truth;
    if (value < nearest.value)
      nearest = {value, diagnosis::Joined(diagnosis::VerdictOf(rival, layout))};
  }
  return nearest;
}

/// Of the signal of `present`.
Separation NearestTo(const Eigen::MatrixXd& H, const Eigen::VectorXd& theta,
                     const diagnosis::ParameterLayout& layout, const std::vector<int>& present,
                     const std::vector<diagnosis::Hypothesis>& rivals) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(theta.size());
  for (const int b : present) {
    const auto& block = layout.Blocks()[b];
    truth.segment(block.first, block.size) = theta.segment(block.first, block.size);
  }
  const Eigen::VectorXd g = H * truth;
  const Explanations explanations(H, g, truth.dot(g), layout);
  return Nearest(explanations, rivals, explanations.CostOf(present), layout);
}

}  // namespace

Eigen::VectorXd WidePrior(const diagnosis::ParameterLayout& layout,
                          const std::vector<int>& present) {
  return layout.Widened(present, std::vector<double>(present.size(), kWidth));
}

Eigen::MatrixXd WithoutGeneric(const diagnosis::LinearProblem& problem,
                               const Eigen::VectorXd& generic_sd) {
  const Eigen::MatrixXd& H = problem.total.H;
  const auto P = Eigen::Index(problem.parameters), G = H.rows() - P;
  Eigen::MatrixXd M = generic_sd.asDiagonal() * H.bottomRightCorner(G, G) * generic_sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::MatrixXd B = generic_sd.asDiagonal() * H.bottomLeftCorner(G, P);
  return H.topLeftCorner(P, P) - B.transpose() * Llt(M).Solve(B);
}

Separation NearestRival(const Eigen::MatrixXd& H, const Eigen::VectorXd& theta,
                        const diagnosis::ParameterLayout& layout, const std::vector<int>& present) {
  auto rivals = diagnosis::KnownHypotheses(layout.EffectCount(), present.size());
  std::erase(rivals, diagnosis::Hypothesis{present, false});
  return NearestTo(H, theta, layout, present, rivals);
}

Separation NearestWithout(const Eigen::MatrixXd& H, const Eigen::VectorXd& theta,
                          const diagnosis::ParameterLayout& layout,
                          const std::vector<int>& present) {
  auto rivals = diagnosis::KnownHypotheses(layout.EffectCount(), 3);
  std::erase_if(rivals, [&](const diagnosis::Hypothesis& rival) {
    return std::ranges::find_first_of(rival.effects, present) != rival.effects.end();
  });
  return NearestTo(H, theta, layout, present, rivals);
}

Separation NearestKnown(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, double c,
                        const diagnosis::ParameterLayout& layout) {
  return Nearest(Explanations(H, g, c, layout), diagnosis::KnownHypotheses(layout.EffectCount(), 2),
                 0.0, layout);
}

}  // namespace flextip::bench
