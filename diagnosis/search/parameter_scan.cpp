#include "diagnosis/search/parameter_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"
#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr double kStep = 0.25;      // of the resolution
constexpr double kSameValue = 0.6;  // of the resolution
constexpr int kMostExact = 128;     // of more only those that look best at first sight
constexpr int kAtATime = 32;        // values, for the sake of large products

ScannedParameter ScannedOf(const Replay& replay, int block) {
  const auto scanned = replay.Layout().Blocks()[block].effect->Scanned(replay.Set());
  FLEXTIP_CHECK(scanned.has_value(), "the effect has a scanned parameter");
  return *scanned;
}

/// Returns the whitened rows' derivatives by the scanned inputs (a column each).
Eigen::MatrixXd ByInputs(const Replay& replay, const WhitenedRows& rows,
                         const ScannedParameter& scanned) {
  Eigen::MatrixXd by_inputs = Eigen::MatrixXd::Zero(rows.e.size(), scanned.inputs);
  for (std::size_t k = 0; k < replay.Samples().size(); ++k) {
    for (int i = 0; i < rows.Rows(k); ++i) {
      const int r = rows.rows[k][i];
      const double sd = replay.RowNoise(k)[r];
      by_inputs.middleRows(rows.first_row[k], rows.Rows(k)) +=
          rows.units[k].col(i) *
          replay.Samples()[k].compared.by_inputs.block(r, scanned.first_input, 1, scanned.inputs) /
          sd;
    }
  }
  return by_inputs;
}

/// The lower triangle of X^T X; stretches of rows in parallel.
Eigen::MatrixXd Squares(const Eigen::MatrixXd& X) {
  constexpr Eigen::Index kParts = 8;
  std::vector<Eigen::MatrixXd> parts(kParts, Eigen::MatrixXd::Zero(X.cols(), X.cols()));
  tbb::parallel_for(Eigen::Index{0}, kParts, [&](Eigen::Index part) {
    const Eigen::Index from = X.rows() * part / kParts, to = X.rows() * (part + 1) / kParts;
    parts[std::size_t(part)].selfadjointView<Eigen::Lower>().rankUpdate(
        X.middleRows(from, to - from).transpose());
  });
  for (std::size_t part = 1; part < parts.size(); ++part) parts[0] += parts[part];
  return parts[0];
}

/// The products of each sample's rows, a column a sample: what a shape, which is one number a
/// sample, needs of them.
struct SampleProducts {
  Eigen::MatrixXd with_X;     ///< B^T X, entry by entry
  Eigen::MatrixXd with_self;  ///< B^T B
  Eigen::MatrixXd with_left;  ///< B^T of what is left

  SampleProducts(const WhitenedRows& rows, const Eigen::MatrixXd& B, const Eigen::MatrixXd& X,
                 const Eigen::VectorXd& left, std::size_t samples) {
    const Eigen::Index inputs = B.cols(), n = static_cast<Eigen::Index>(samples);
    with_X.resize(inputs * X.cols(), n);
    with_self.resize(inputs * inputs, n);
    with_left.resize(inputs, n);
    tbb::parallel_for(Eigen::Index{0}, n, [&](Eigen::Index k) {
      const auto at = static_cast<std::size_t>(k);
      const Eigen::MatrixXd b = B.middleRows(rows.first_row[at], rows.Rows(at));
      const auto x = X.middleRows(rows.first_row[at], rows.Rows(at));
      with_X.col(k) = (b.transpose() * x).reshaped();
      with_self.col(k) = (b.transpose() * b).reshaped();
      with_left.col(k) = b.transpose() * left.segment(rows.first_row[at], rows.Rows(at));
    });
  }
};

/// The fall of chi-squared by pairs of shapes (a row a sample; first all first ones, then all
/// second ones) of each input. Many pairs at a time: the products are large. Without `llt`, of
/// what the other parameters may explain, the shapes count as apart from all of that: a lower
/// bound.
std::vector<double> Scores(const SampleProducts& products, const Eigen::MatrixXd& shapes,
                           const Llt<Eigen::Dynamic>* llt) {
  const Eigen::Index inputs = products.with_left.rows(), pairs = shapes.cols() / 2;
  const Eigen::Index parameters = products.with_X.rows() / inputs;
  const auto first = shapes.leftCols(pairs), second = shapes.rightCols(pairs);
  Eigen::MatrixXd squares(shapes.rows(), 3 * pairs);
  squares << first.cwiseAbs2(), first.cwiseProduct(second), second.cwiseAbs2();
  const Eigen::MatrixXd by_left = products.with_left * shapes;
  const Eigen::MatrixXd by_self = products.with_self * squares;
  Eigen::MatrixXd by_X;
  if (llt != nullptr) by_X = products.with_X * shapes;
  std::vector<double> scores;
  for (Eigen::Index c = 0; c < pairs; ++c) {
    const auto self = [&](Eigen::Index which) {
      return by_self.col(which * pairs + c).reshaped(inputs, inputs);
    };
    Eigen::MatrixXd A(2 * inputs, 2 * inputs);
    A << self(0), self(1), self(1).transpose(), self(2);
    if (llt != nullptr) {
      Eigen::MatrixXd XB(parameters, 2 * inputs);
      XB << by_X.col(c).reshaped(inputs, parameters).transpose(),
          by_X.col(pairs + c).reshaped(inputs, parameters).transpose();
      A -= XB.transpose() * llt->Solve(XB);
    }
    A.diagonal().array() += 1e-9 * A.trace() + 1e-12;
    Eigen::VectorXd b(2 * inputs);
    b << by_left.col(c), by_left.col(pairs + c);
    scores.push_back(b.dot(Eigen::VectorXd(Llt(A).Solve(b))));
  }
  return scores;
}

}  // namespace

double BestScannedValue(const Replay& replay, int block) {
  const ScannedParameter scanned = ScannedOf(replay, block);
  const auto& own = replay.Layout().Blocks()[block];
  const WhitenedRows rows = replay.Whiten();
  const SampleSet& set = replay.Set();
  const Eigen::MatrixXd by_inputs = ByInputs(replay, rows, scanned);
  // The effect's own parameters at an earlier value are to be found again.
  Eigen::VectorXd sd = replay.Layout().Tolerances();
  sd.segment(own.first, own.size).setZero();
  const Eigen::MatrixXd X = rows.X * sd.asDiagonal();
  Eigen::MatrixXd M = Squares(X);
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::VectorXd z = rows.e + rows.X * replay.Theta();
  const Eigen::VectorXd left = z - X * llt.Solve(X.transpose() * z);

  const double step = kStep * scanned.resolution;
  const int count = std::max(2, int((scanned.highest - scanned.lowest) / step));
  const SampleProducts products(rows, by_inputs, X, left, set.samples.size());
  const auto scores = [&](const std::vector<int>& candidates, const Llt<Eigen::Dynamic>* others) {
    std::vector<double> found(candidates.size(), 0.0);
    const int wanted = static_cast<int>(candidates.size());
    tbb::parallel_for(0, (wanted + kAtATime - 1) / kAtATime, [&](int chunk) {
      const int from = chunk * kAtATime, pairs = std::min(kAtATime, wanted - from);
      Eigen::MatrixXd shapes(static_cast<Eigen::Index>(set.samples.size()), 2 * pairs);
      for (int c = 0; c < pairs; ++c) {
        const double value = scanned.lowest + candidates[from + c] * step;
        for (std::size_t k = 0; k < set.samples.size(); ++k) {
          const Eigen::Vector2d both = own.effect->ScanShapes(value, {set, k, set.samples[k].t_s});
          shapes(static_cast<Eigen::Index>(k), c) = both[0];
          shapes(static_cast<Eigen::Index>(k), pairs + c) = both[1];
        }
      }
      std::ranges::copy(Scores(products, shapes, others), found.begin() + from);
    });
    return found;
  };
  std::vector<int> candidates(count);
  std::iota(candidates.begin(), candidates.end(), 0);
  if (count > kMostExact) {
    const std::vector<double> apart = scores(candidates, nullptr);
    std::ranges::stable_sort(candidates, [&](int a, int b) { return apart[a] > apart[b]; });
    candidates.resize(kMostExact);
  }
  const std::vector<double> score = scores(candidates, &llt);
  const auto best = std::max_element(score.begin(), score.end()) - score.begin();
  return scanned.lowest + candidates[best] * step;
}

void ScanAgain(Replay& replay, ParameterLayout& layout, int block) {
  const ScannedParameter scanned = ScannedOf(replay, block);
  const auto& own = layout.Blocks()[block];
  const double found = BestScannedValue(replay, block);
  Eigen::VectorXd theta = replay.Theta();
  const double now = own.effect->ScanCentre() + theta[own.first + scanned.correction];
  if (std::abs(found - now) < kSameValue * scanned.resolution) return;
  layout.MutableEffect(block).SetScanCentre(found);
  theta.segment(own.first, own.size).setZero();
  replay.Evaluate(theta);
}

std::vector<double> ScanCentres(const ParameterLayout& layout) {
  std::vector<double> centres;
  for (const int block : layout.ScannedBlocks())
    centres.push_back(layout.Blocks()[block].effect->ScanCentre());
  return centres;
}

void SetScanCentres(ParameterLayout& layout, const std::vector<double>& centres) {
  const auto& blocks = layout.ScannedBlocks();
  FLEXTIP_CHECK(centres.size() == blocks.size(), "a centre for each scanned parameter");
  for (std::size_t i = 0; i < blocks.size(); ++i)
    layout.MutableEffect(blocks[i]).SetScanCentre(centres[i]);
}

}  // namespace flextip::diagnosis
