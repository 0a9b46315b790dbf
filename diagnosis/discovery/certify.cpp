#include "diagnosis/discovery/certify.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

constexpr double kFreely = 1000.0;
constexpr std::size_t kRivals = 6;

/// The variance of a mean of the residuals over that of white ones, times their mean square: by
/// correlations over a twentieth of the series, the farther the less (Newey & West 1987). At least
/// 1.
double LongRunFactor(const std::vector<double>& residuals) {
  const std::size_t n = residuals.size(), reach = n / 20;
  double squares = 0.0, sum = 0.0;
  for (std::size_t lag = 0; lag <= reach && lag < n; ++lag) {
    double products = 0.0;
    for (std::size_t i = lag; i < n; ++i) products += residuals[i] * residuals[i - lag];
    if (lag == 0) squares = products;
    sum += (lag == 0 ? 1.0 : 2.0 * (1.0 - double(lag) / double(reach + 1))) * products;
  }
  return n == 0 || squares <= 0.0 ? 1.0 : std::max(1.0, sum / double(n));
}

}  // namespace

double StudentTail(double t, double freedom) {
  if (t <= 0.0) return 0.5;
  const double n = std::max(1.0, freedom);
  const double z = (8.0 * n + 1.0) / (8.0 * n + 3.0) * std::sqrt(n * std::log1p(t * t / n));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

double FalseDiscovery(const ResidualProblem& problem, const Term& term,
                      const std::vector<double>& seen, const std::vector<double>& unseen) {
  const WeightedProblem half(problem, seen);
  const Eigen::MatrixXd& X = problem.Derivatives();
  Eigen::MatrixXd C =
      problem.Moved(term, SeriesOf(term, StatesOf(problem.Of(), term.target)), true);
  for (Eigen::Index j = 0; j < C.cols(); ++j) {
    const double norm = C.col(j).norm();
    if (norm > 0.0) C.col(j) *= kFreely * std::sqrt(double(C.rows())) / norm;
  }
  const Eigen::Index P = X.cols(), m = C.cols();
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(P + m, P + m);
  M.topLeftCorner(P, P) = half.information;
  Eigen::VectorXd g = Eigen::VectorXd::Zero(P + m);
  g.head(P) = half.right;
  for (int b = 0; b < problem.Blocks(); ++b) {
    const double w = seen[static_cast<std::size_t>(b)];
    if (w == 0.0) continue;
    const int first = problem.FirstRow(b), count = problem.FirstRow(b + 1) - first;
    const auto x = X.middleRows(first, count);
    const auto c = C.middleRows(first, count);
    M.topRightCorner(P, m) += w * (x.transpose() * c);
    M.bottomRightCorner(m, m) += w * (c.transpose() * c);
    g.tail(m) += w * (c.transpose() * problem.Left().segment(first, count));
  }
  M.bottomLeftCorner(m, P) = M.topRightCorner(P, m).transpose();
  const Eigen::VectorXd with = Llt(M).Solve(g);
  const Eigen::VectorXd without = Llt(half.information).Solve(half.right);
  // By block: the prediction with what is there, and with itself.
  std::vector<double> there, itself;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int b = 0; b < problem.Blocks(); ++b) {
    if (unseen[static_cast<std::size_t>(b)] == 0.0) continue;
    const int first = problem.FirstRow(b), count = problem.FirstRow(b + 1) - first;
    const auto x = X.middleRows(first, count);
    const Eigen::VectorXd p =
        x * (with.head(P) - without) + C.middleRows(first, count) * with.tail(m);
    const Eigen::VectorXd left = problem.Left().segment(first, count) - x * without;
    there.push_back(p.dot(left));
    itself.push_back(p.squaredNorm());
    sum += there.back();
    squares += itself.back();
    fourth += itself.back() * itself.back();
  }
  if (!(squares > 0.0)) return 1.0;
  const double slope = sum / squares;
  double scatter = 0.0;
  for (std::size_t i = 0; i < there.size(); ++i)
    scatter += std::pow(there[i] - slope * itself[i], 2);
  // A prediction that is more than twice too large makes things worse.
  if (slope < 0.5) return 1.0;
  return StudentTail(sum / std::sqrt(std::max(scatter, squares)), squares * squares / fourth - 1.0);
}

double SamplesAsOne(const ResidualProblem& problem, const Term& term,
                    const StatesByTarget& states) {
  ResidualProblem with = problem;
  const Eigen::MatrixXd moved = problem.Moved(term, SeriesOf(term, states.at(term.target)), true);
  with.Free(moved);
  const WeightedProblem all(with, std::vector<double>(std::size_t(with.Blocks()), 1.0));
  const Eigen::VectorXd x = Llt(all.information).Solve(all.right);
  const Eigen::VectorXd left = with.Left() - with.Derivatives() * x;
  const Eigen::VectorXd by = with.Derivatives().rightCols(moved.cols()) * x.tail(moved.cols());
  std::array<std::vector<double>, row::kCount> series;
  std::array<double, row::kCount> energy{};
  for (std::size_t k = 0; k < with.Of().Samples().size(); ++k) {
    for (std::size_t i = 0; i < with.RowsOf(k).size(); ++i) {
      const auto at = with.FirstRowOfSample(k) + Eigen::Index(i);
      const auto r = static_cast<std::size_t>(with.RowsOf(k)[i]);
      series[r].push_back(left[at]);
      energy[r] += by[at] * by[at];
    }
  }
  double sum = 0.0, weights = 0.0;
  for (std::size_t r = 0; r < series.size(); ++r) {
    sum += energy[r] * LongRunFactor(series[r]);
    weights += energy[r];
  }
  return weights > 0.0 ? sum / weights : 1.0;
}

double Stability(const ResidualProblem& problem, const std::vector<Candidate>& leaders,
                 const StatesByTarget& states, int bags) {
  std::mt19937_64 rng(5);
  const std::size_t count = std::min(leaders.size(), kRivals);
  std::vector<std::vector<double>> weights;
  for (int bag = 0; bag < bags; ++bag) {
    auto& weight = weights.emplace_back(static_cast<std::size_t>(problem.Blocks()), 0.0);
    std::uniform_int_distribution<std::size_t> draw(0, weight.size() - 1);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[draw(rng)] += 1.0;
  }
  std::atomic<int> stable = 0;
  tbb::parallel_for(std::size_t{0}, weights.size(), [&](std::size_t bag) {
    const WeightedProblem weighted(problem, weights[bag]);
    std::vector<Candidate> again(leaders.begin(), leaders.begin() + std::ptrdiff_t(count));
    double best = 0.0;
    for (Candidate& one : again) {
      const TargetScan scan(weighted, one.term.target);
      const TermSeries series = SeriesOf(one.term, states.at(one.term.target));
      one.gain = scan.OffsetGain() + scan.Gain(one.term, series);
      best = std::max(best, one.gain);
    }
    const double variance = VarianceLeft(weighted, best);
    std::size_t first = 0;
    for (std::size_t i = 0; i < again.size(); ++i) {
      again[i].criterion = Criterion(again[i], variance, weighted.samples);
      if (again[i].criterion > again[first].criterion) first = i;
    }
    stable += again[first].criterion > 0.0 && again[first].term.target == leaders[0].term.target;
  });
  return double(stable) / double(bags);
}

}  // namespace flextip::diagnosis
