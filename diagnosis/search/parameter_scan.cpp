#include "diagnosis/search/parameter_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "core/check.h"
#include "core/linear_algebra.h"
#include "core/products/products.h"

namespace flextip::diagnosis {
namespace {

constexpr double kStep = 0.25;        // of the resolution
constexpr double kSameValue = 0.6;    // of the resolution
constexpr int kMostExact = 128;       // of more only those that look best at first sight
constexpr std::size_t kAtATime = 32;  // values, for the sake of large products

ScannedParameter ScannedOf(const Replay& replay, int block) {
  const auto scanned = replay.Layout().Blocks()[block].effect->Scanned(replay.Set());
  FLEXTIP_CHECK(scanned.has_value(), "the effect has a scanned parameter");
  return *scanned;
}

/// The products of each sample's rows, a column a sample: what a shape, which is one number a
/// sample, needs of them.
struct SampleProducts {
  Eigen::MatrixXd with_X;     ///< B^T X, entry by entry
  Eigen::MatrixXd with_self;  ///< B^T B
  Eigen::MatrixXd with_left;  ///< B^T of what is left
};

/// The lower triangle of X^T X; stretches of rows in parallel.
Eigen::MatrixXd Squares(const RowMajorMatrix& X) {
  constexpr Eigen::Index kParts = 8;
  std::vector<Eigen::MatrixXd> parts(kParts, Eigen::MatrixXd::Zero(X.cols(), X.cols()));
  tbb::parallel_for(Eigen::Index{0}, kParts, [&](Eigen::Index part) {
    const Eigen::Index from = X.rows() * part / kParts, to = X.rows() * (part + 1) / kParts;
    AddSquares(X.middleRows(from, to - from), parts[std::size_t(part)]);
  });
  for (std::size_t part = 1; part < parts.size(); ++part) parts[0] += parts[part];
  return parts[0].transpose();
}

/// The fall of chi-squared by pairs of shapes (a row a sample; first all first ones, then all
/// second ones) of each input. Many pairs at a time: the products are large. Without `llt`, of
/// what the other parameters may explain, the shapes count as apart from all of that: a lower
/// bound. `sd` of the other parameters.
std::vector<double> Scores(const SampleProducts& products, const Eigen::MatrixXd& shapes,
                           const Eigen::VectorXd& sd, const Llt<Eigen::Dynamic>* llt) {
  const Eigen::Index inputs = products.with_left.rows(), pairs = shapes.cols() / 2;
  const auto first = shapes.leftCols(pairs), second = shapes.rightCols(pairs);
  Eigen::MatrixXd squares(shapes.rows(), 3 * pairs);
  squares << first.cwiseAbs2(), first.cwiseProduct(second), second.cwiseAbs2();
  const Eigen::MatrixXd by_left = products.with_left * shapes;
  const Eigen::MatrixXd by_self = products.with_self * squares;
  Eigen::MatrixXd by_X;
  if (llt != nullptr) {
    by_X = Eigen::MatrixXd::Zero(products.with_X.rows(), shapes.cols());
    AddProduct(products.with_X, shapes, by_X);
  }
  std::vector<double> scores;
  for (Eigen::Index c = 0; c < pairs; ++c) {
    const auto self = [&](Eigen::Index which) {
      return by_self.col(which * pairs + c).reshaped(inputs, inputs);
    };
    Eigen::MatrixXd A(2 * inputs, 2 * inputs);
    A << self(0), self(1), self(1).transpose(), self(2);
    if (llt != nullptr) {
      Eigen::MatrixXd XB(sd.size(), 2 * inputs);
      XB << by_X.col(c).reshaped(inputs, sd.size()).transpose(),
          by_X.col(pairs + c).reshaped(inputs, sd.size()).transpose();
      const Eigen::MatrixXd apart = llt->SolveL(Eigen::MatrixXd(sd.asDiagonal() * XB));
      A.noalias() -= apart.transpose() * apart;
    }
    A.diagonal().array() += 1e-9 * A.trace() + 1e-12;
    Eigen::VectorXd b(2 * inputs);
    b << by_left.col(c), by_left.col(pairs + c);
    scores.push_back(b.dot(Eigen::VectorXd(Llt(A).Solve(b))));
  }
  return scores;
}

/// Sine and cosine of the phases of each sample (a row) at values of a scanned parameter: first all
/// sines, then all cosines. Values one step apart follow from each other by a turn.
class Shapes {
 public:
  Shapes(const Effect& effect, const SampleSet& set, double lowest, double step)
      : phase_(Eigen::Index(set.samples.size())), lowest_(lowest), step_(step) {
    for (std::size_t k = 0; k < set.samples.size(); ++k)
      phase_[Eigen::Index(k)] = effect.ScannedPhase({set, k, set.samples[k].t_s});
    turn_cos_ = (step_ * phase_).cos();
    turn_sin_ = (step_ * phase_).sin();
  }

  /// At `lowest` plus so many steps each.
  Eigen::MatrixXd At(std::span<const int> steps) const {
    const auto pairs = Eigen::Index(steps.size());
    Eigen::MatrixXd shapes(phase_.size(), 2 * pairs);
    for (Eigen::Index c = 0; c < pairs; ++c) {
      auto sine = shapes.col(c).array(), cosine = shapes.col(pairs + c).array();
      const int at = steps[std::size_t(c)];
      if (c > 0 && at == steps[std::size_t(c - 1)] + 1) {
        const auto sine_before = shapes.col(c - 1).array();
        const auto cosine_before = shapes.col(pairs + c - 1).array();
        sine = sine_before * turn_cos_ + cosine_before * turn_sin_;
        cosine = cosine_before * turn_cos_ - sine_before * turn_sin_;
      } else {
        const double value = lowest_ + at * step_;
        sine = (value * phase_).sin();
        cosine = (value * phase_).cos();
      }
    }
    return shapes;
  }

 private:
  Eigen::ArrayXd phase_;  // a unit of the parameter turns by so much
  double lowest_, step_;
  Eigen::ArrayXd turn_cos_, turn_sin_;
};

/// What all scans from where a replay stands have in common.
class Scan {
 public:
  explicit Scan(const Replay& replay)
      : replay_(replay),
        rows_(replay.Whiten()),
        H_(Squares(rows_.X)),
        z_(rows_.e + rows_.X * replay.Theta()),
        Xz_(rows_.X.transpose() * z_) {}

  /// Returns the best value for block `block`, the others of prior deviations `sd`.
  double Best(int block, Eigen::VectorXd sd) const;

 private:
  /// Returns the whitened rows' derivatives by the scanned inputs (a column each).
  Eigen::MatrixXd ByInputs(const ScannedParameter& scanned) const;
  SampleProducts ProductsWith(const Eigen::MatrixXd& B, const Eigen::VectorXd& left) const;

  const Replay& replay_;
  WhitenedRows rows_;
  Eigen::MatrixXd H_;  // the lower triangle of X^T X
  Eigen::VectorXd z_, Xz_;
};

Eigen::MatrixXd Scan::ByInputs(const ScannedParameter& scanned) const {
  Eigen::MatrixXd by_inputs = Eigen::MatrixXd::Zero(rows_.e.size(), scanned.inputs);
  for (std::size_t k = 0; k < replay_.Samples().size(); ++k) {
    const Rows sd = replay_.RowNoise(k);
    for (int i = 0; i < rows_.Rows(k); ++i) {
      const int r = rows_.rows[k][i];
      by_inputs.middleRows(rows_.first_row[k], rows_.Rows(k)) +=
          rows_.units[k].col(i) *
          replay_.Samples()[k].compared.by_inputs.block(r, scanned.first_input, 1, scanned.inputs) /
          sd[r];
    }
  }
  return by_inputs;
}

SampleProducts Scan::ProductsWith(const Eigen::MatrixXd& B, const Eigen::VectorXd& left) const {
  const auto n = Eigen::Index(replay_.Samples().size());
  const Eigen::Index inputs = B.cols(), P = rows_.X.cols();
  SampleProducts products{Eigen::MatrixXd(inputs * P, n), Eigen::MatrixXd(inputs * inputs, n),
                          Eigen::MatrixXd(inputs, n)};
  tbb::parallel_for(Eigen::Index{0}, n, [&](Eigen::Index k) {
    const int first = rows_.first_row[std::size_t(k)], count = rows_.Rows(std::size_t(k));
    const Eigen::MatrixXd b = B.middleRows(first, count);
    products.with_X.col(k) = (b.transpose() * rows_.X.middleRows(first, count)).reshaped();
    products.with_self.col(k) = (b.transpose() * b).reshaped();
    products.with_left.col(k) = b.transpose() * left.segment(first, count);
  });
  return products;
}

double Scan::Best(int block, Eigen::VectorXd sd) const {
  const ScannedParameter scanned = ScannedOf(replay_, block);
  const auto& own = replay_.Layout().Blocks()[block];
  // The effect's own parameters at an earlier value are to be found again.
  sd.segment(own.first, own.size).setZero();
  Eigen::MatrixXd M = sd.asDiagonal() * H_ * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::VectorXd others =
      sd.asDiagonal() * Eigen::VectorXd(llt.Solve(Eigen::VectorXd(sd.asDiagonal() * Xz_)));
  const SampleProducts products = ProductsWith(ByInputs(scanned), z_ - rows_.X * others);

  const double step = kStep * scanned.resolution;
  const int count = std::max(2, int((scanned.highest - scanned.lowest) / step));
  const Shapes shapes(*own.effect, replay_.Set(), scanned.lowest, step);
  const auto scores = [&](std::span<const int> candidates, const Llt<Eigen::Dynamic>* of_others) {
    std::vector<double> found(candidates.size(), 0.0);
    const std::size_t wanted = candidates.size();
    tbb::parallel_for(std::size_t{0}, (wanted + kAtATime - 1) / kAtATime, [&](std::size_t chunk) {
      const std::size_t from = chunk * kAtATime;
      const auto some = candidates.subspan(from, std::min(kAtATime, wanted - from));
      std::ranges::copy(Scores(products, shapes.At(some), sd, of_others),
                        found.begin() + std::ptrdiff_t(from));
    });
    return found;
  };
  std::vector<int> candidates(count);
  std::iota(candidates.begin(), candidates.end(), 0);
  if (count > kMostExact) {
    const std::vector<double> apart = scores(candidates, nullptr);
    std::ranges::stable_sort(candidates, [&](int a, int b) { return apart[a] > apart[b]; });
    candidates.resize(kMostExact);
    std::ranges::sort(candidates);
  }
  const std::vector<double> score = scores(candidates, &llt);
  const auto best = std::max_element(score.begin(), score.end()) - score.begin();
  return scanned.lowest + candidates[best] * step;
}

}  // namespace

void ScanAgain(Replay& replay, ParameterLayout& layout, const std::vector<int>& blocks,
               const Eigen::VectorXd& prior_sd) {
  std::optional<Scan> scan;
  for (const int block : blocks) {
    if (!scan) scan.emplace(replay);
    const ScannedParameter scanned = ScannedOf(replay, block);
    const auto& own = layout.Blocks()[block];
    const double found = scan->Best(block, prior_sd);
    Eigen::VectorXd theta = replay.Theta();
    const double now = own.effect->ScanCentre() + theta[own.first + scanned.correction];
    if (std::abs(found - now) < kSameValue * scanned.resolution) continue;
    layout.MutableEffect(block).SetScanCentre(found);
    theta.segment(own.first, own.size).setZero();
    replay.Evaluate(theta);
    scan.reset();
  }
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
