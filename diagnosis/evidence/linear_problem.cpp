#include "diagnosis/evidence/linear_problem.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/products/products.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kStretch = 64;  // samples whose products are made at a time

/// The place of the pair (a, b), a <= b, among all pairs of `count`.
Eigen::Index PairOf(Eigen::Index a, Eigen::Index b, Eigen::Index count) {
  return a * count - a * (a - 1) / 2 + b - a;
}

/// Products of two columns each, in the order of PairOf.
Eigen::MatrixXd PairsOfColumns(const Eigen::MatrixXd& columns) {
  const Eigen::Index J = columns.cols();
  Eigen::MatrixXd pairs(columns.rows(), J * (J + 1) / 2);
  for (Eigen::Index j = 0; j < J; ++j)
    pairs.middleCols(PairOf(j, j, J), J - j) =
        columns.rightCols(J - j).array().colwise() * columns.col(j).array();
  return pairs;
}

/// Sums of stretches of samples. The generic columns are Kronecker products of the rows' units with
/// the basis, so their sums are too. Of what is symmetric only one half is summed.
class BlockBuilder {
 public:
  BlockBuilder(const Replay& replay, const WhitenedRows& rows, const Eigen::MatrixXd& basis,
               const std::vector<int>& row_place)
      : theta_(replay.Theta()),
        rows_(rows),
        basis_(basis),
        basis_pairs_(PairsOfColumns(basis)),
        row_place_(row_place) {}

  NormalSums Build(std::size_t begin, std::size_t end, Eigen::Index size) const {
    NormalSums sums(size);
    const int first = rows_.first_row[begin], count = rows_.first_row[end] - first;
    const auto P = rows_.X.cols();
    if (count == 0) return sums;
    const auto X = rows_.X.middleRows(first, count);
    const Eigen::VectorXd z = rows_.e.segment(first, count) + X * theta_;
    Eigen::MatrixXd XX = Eigen::MatrixXd::Zero(P, P);
    AddSquares(X, XX);
    sums.H.topLeftCorner(P, P) = XX;
    sums.g.head(P).noalias() = X.transpose() * z;
    sums.c = z.squaredNorm();
    sums.rows = count;
    if (basis_.cols() > 0) AddGeneric(begin, end, z, sums);
    return sums;
  }

 private:
  /// Of a stretch of samples: what an error in each row becomes (`U`), with the parameters' columns
  /// and with z, a column a sample, and with itself by pairs, a row a sample.
  struct Products {
    Eigen::MatrixXd XU, UU, Uz;

    Products(Eigen::Index P, Eigen::Index R, Eigen::Index samples)
        : XU(Eigen::MatrixXd::Zero(P * R, samples)),
          UU(Eigen::MatrixXd::Zero(samples, R * (R + 1) / 2)),
          Uz(Eigen::MatrixXd::Zero(R, samples)) {}
  };

  void Fill(std::size_t k, Eigen::Index at, Eigen::Index R, const Eigen::VectorXd& z,
            std::ptrdiff_t first_of_z, Products& products) const {
    const auto P = rows_.X.cols();
    const int count = rows_.Rows(k), first = rows_.first_row[k];
    const Eigen::MatrixXd& U = rows_.units[k];
    const Eigen::MatrixXd UU = U.transpose() * U;
    const Eigen::MatrixXd XU = rows_.X.middleRows(first, count).transpose() * U;
    const Eigen::VectorXd Uz = U.transpose() * z.segment(first - first_of_z, count);
    for (int a = 0; a < count; ++a) {
      const Eigen::Index row = row_place_[rows_.rows[k][a]];
      products.XU.block(row * P, at, P, 1) = XU.col(a);
      products.Uz(row, at) = Uz[a];
      for (int b = a; b < count; ++b)
        products.UU(at, PairOf(row, row_place_[rows_.rows[k][b]], R)) = UU(a, b);
    }
  }

  /// A row's generic column is what an error in the row becomes, times the basis: sums over samples
  /// of products of the one and products of the other, as matrix products.
  void AddGeneric(std::size_t begin, std::size_t end, const Eigen::VectorXd& z,
                  NormalSums& sums) const {
    const auto P = rows_.X.cols(), J = basis_.cols(), R = (sums.g.size() - P) / J;
    Eigen::MatrixXd XU_phi = Eigen::MatrixXd::Zero(P * R, J);
    Eigen::MatrixXd phi_UU = Eigen::MatrixXd::Zero(basis_pairs_.cols(), R * (R + 1) / 2);
    Eigen::MatrixXd Uz_phi = Eigen::MatrixXd::Zero(R, J);
    for (std::size_t from = begin; from < end; from += kStretch) {
      const auto n = Eigen::Index(std::min(kStretch, end - from));
      Products products(P, R, n);
      for (Eigen::Index at = 0; at < n; ++at)
        Fill(from + std::size_t(at), at, R, z, rows_.first_row[begin], products);
      const auto phi = basis_.middleRows(Eigen::Index(from), n);
      AddProduct(products.XU, phi, XU_phi);
      AddTransposedProduct(basis_pairs_.middleRows(Eigen::Index(from), n), products.UU, phi_UU);
      Uz_phi.noalias() += products.Uz * phi;
    }
    for (Eigen::Index a = 0; a < R; ++a) {
      sums.g.segment(P + a * J, J) = Uz_phi.row(a);
      sums.H.block(0, P + a * J, P, J) = XU_phi.middleRows(a * P, P);
      for (Eigen::Index b = a; b < R; ++b)
        for (Eigen::Index i = 0; i < J; ++i) {
          const auto pairs = phi_UU.col(PairOf(a, b, R)).segment(PairOf(i, i, J), J - i);
          sums.H.col(P + b * J + i).segment(P + a * J + i, J - i) = pairs;
          sums.H.row(P + a * J + i).segment(P + b * J + i, J - i) = pairs;
        }
    }
  }

  const Eigen::VectorXd& theta_;
  const WhitenedRows& rows_;
  const Eigen::MatrixXd& basis_;
  const Eigen::MatrixXd basis_pairs_;
  const std::vector<int>& row_place_;
};

/// What force and wrist leave of the residual, row by row, in its noise's standard deviations.
Rows ResidualSize(const WhitenedRows& rows) {
  Rows squares = Rows::Zero(), count = Rows::Zero();
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    if (rows.Rows(k) == 0) continue;
    const Eigen::VectorXd left =
        rows.units[k].transpose() * rows.e.segment(rows.first_row[k], rows.Rows(k));
    for (int i = 0; i < rows.Rows(k); ++i) {
      squares[rows.rows[k][i]] += left[i] * left[i];
      count[rows.rows[k][i]] += 1.0;
    }
  }
  return (squares.array() / count.array().max(1.0)).sqrt();
}

}  // namespace

void NormalSums::Add(const NormalSums& other, double weight) {
  H += weight * other.H;
  g += weight * other.g;
  volume += weight * other.volume;
  c += weight * other.c;
  rows += std::lround(weight * double(other.rows));
}

void LinearProblem::Know(const NormalSums& others) {
  known = others;
  total.Add(known);
}

void LinearProblem::CountAsOne(double samples) {
  const auto divide = [&](NormalSums& sums) {
    sums.H /= samples;
    sums.g /= samples;
    sums.c /= samples;
    sums.volume /= samples;
  };
  divide(total);
  for (NormalSums& block : blocks) divide(block);
}

LinearProblem MakeLinearProblem(const Replay& replay, const Eigen::MatrixXd& basis, int blocks) {
  const WhitenedRows rows = replay.Whiten();
  LinearProblem problem;
  problem.parameters = int(rows.X.cols());
  std::vector<int> row_place(row::kCount, -1);
  std::vector<int> used;
  for (const auto& of_sample : rows.rows)
    for (const int r : of_sample)
      if (row_place[r] < 0) row_place[r] = 0;
  for (int r = 0; r < row::kCount; ++r) {
    if (row_place[r] < 0 || basis.cols() == 0) continue;
    row_place[r] = int(used.size());
    used.push_back(r);
    for (Eigen::Index j = 0; j < basis.cols(); ++j) problem.generic_row.push_back(r);
  }
  problem.blocks.resize(blocks);
  const std::size_t n = replay.Samples().size();
  const BlockBuilder builder(replay, rows, basis, row_place);
  tbb::parallel_for(0, blocks, [&](int b) {
    problem.blocks[b] = builder.Build(n * b / blocks, n * (b + 1) / blocks, problem.Size());
  });
  problem.total = NormalSums(problem.Size());
  for (const NormalSums& block : problem.blocks) problem.total.Add(block);
  problem.residual_size = ResidualSize(rows);
  // Only upper halves were summed.
  for (NormalSums* sums : {&problem.total}) {
    sums->H.triangularView<Eigen::StrictlyLower>() =
        sums->H.transpose().triangularView<Eigen::StrictlyLower>();
  }
  for (NormalSums& sums : problem.blocks)
    sums.H.triangularView<Eigen::StrictlyLower>() =
        sums.H.transpose().triangularView<Eigen::StrictlyLower>();
  return problem;
}

}  // namespace flextip::diagnosis
