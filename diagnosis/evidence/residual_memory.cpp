#include "diagnosis/evidence/residual_memory.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "diagnosis/evidence/linear_problem.h"

namespace flextip::diagnosis {
namespace {

constexpr double kFewest = 60;        // residuals of a row
constexpr double kChance = 3.0;       // standard deviations that chance explains
constexpr double kMostMemory = 0.98;  // a coefficient that a recording can tell

using RowSeries = std::array<std::vector<double>, row::kCount>;

/// The whitened residuals of each measured row, in order of time.
RowSeries LeftBy(const Eigen::VectorXd& x, const Replay& replay, const Eigen::MatrixXd& basis,
                 const LinearProblem& problem) {
  const WhitenedRows rows = replay.Whiten();
  const auto P = rows.X.cols(), J = basis.cols();
  std::array<Eigen::Index, row::kCount> first_term{};
  for (std::size_t g = problem.generic_row.size(); g-- > 0;)
    first_term[problem.generic_row[g]] = P + Eigen::Index(g);
  const Eigen::VectorXd e = rows.e - rows.X * (x.head(P) - replay.Theta());
  RowSeries left;
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    const auto count = Eigen::Index(rows.rows[k].size());
    if (count == 0) continue;
    Eigen::VectorXd missed(count);
    for (Eigen::Index a = 0; a < count; ++a)
      missed[a] = basis.row(Eigen::Index(k)).dot(x.segment(first_term[rows.rows[k][a]], J));
    const Eigen::VectorXd of_sample = e.segment(rows.first_row[k], count) - rows.units[k] * missed;
    for (Eigen::Index a = 0; a < count; ++a) left[rows.rows[k][a]].push_back(of_sample[a]);
  }
  return left;
}

}  // namespace

ResidualMemory MemoryOfSeries(const std::vector<double>& residuals) {
  ResidualMemory memory;
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    squares += residuals[i] * residuals[i];
    if (i > 0) products += residuals[i] * residuals[i - 1];
  }
  const double count = double(residuals.size());
  if (count < kFewest || squares <= 0.0) return memory;
  const double chance = kChance / std::sqrt(count);
  const double rho = std::clamp(products / squares, 0.0, kMostMemory);
  memory.correlation = rho > chance ? rho : 0.0;
  const double slow = (1.0 + memory.correlation) / (1.0 - memory.correlation);
  const double mean_square = squares / count;
  const bool by_chance = mean_square > 1.0 && mean_square < 1.0 + chance * std::sqrt(2.0 * slow);
  memory.slow_variance = slow * (by_chance ? 1.0 : mean_square);
  return memory;
}

ResidualMemory MemoryOfResiduals(const Replay& replay, const Eigen::MatrixXd& basis,
                                 const LinearProblem& problem, const Eigen::VectorXd& x) {
  const RowSeries left = LeftBy(x, replay, basis, problem);
  ResidualMemory most;
  for (const Channel& channel : kChannels) {
    for (int r = channel.first_row; r < channel.first_row + channel.rows; ++r) {
      ResidualMemory memory = MemoryOfSeries(left[r]);
      if (memory.slow_variance <= most.slow_variance) continue;
      most = memory;
      most.channel = channel.name;
    }
  }
  return most;
}

}  // namespace flextip::diagnosis
