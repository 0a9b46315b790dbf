#include "diagnosis/evidence/linear_problem.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {
namespace {

/// Adds one stretch of samples to `sums`. The generic columns are Kronecker products of the rows'
/// units with the basis, so their sums are too.
class BlockBuilder {
 public:
  BlockBuilder(const Replay& replay, const WhitenedRows& rows, const Eigen::MatrixXd& basis,
               const std::vector<int>& row_place)
      : theta_(replay.Theta()), rows_(rows), basis_(basis), row_place_(row_place) {}

  NormalSums Build(std::size_t begin, std::size_t end, Eigen::Index size) const {
    NormalSums sums(size);
    const int first = rows_.first_row[begin], count = rows_.first_row[end] - first;
    const auto P = rows_.X.cols();
    if (count == 0) return sums;
    const auto X = rows_.X.middleRows(first, count);
    const Eigen::VectorXd z = rows_.e.segment(first, count) + X * theta_;
    sums.H.topLeftCorner(P, P).selfadjointView<Eigen::Upper>().rankUpdate(X.transpose());
    sums.g.head(P).noalias() = X.transpose() * z;
    sums.c = z.squaredNorm();
    sums.rows = count;
    if (basis_.cols() > 0) AddGeneric(begin, end, z, sums);
    return sums;
  }

 private:
  /// A row's generic column is what an error in the row becomes, times the basis: sums over samples
  /// of products of the one and products of the other, as matrix products.
  void AddGeneric(std::size_t begin, std::size_t end, const Eigen::VectorXd& z,
                  NormalSums& sums) const {
    const auto P = rows_.X.cols(), J = basis_.cols(), R = (sums.g.size() - P) / J;
    const auto n = Eigen::Index(end - begin);
    const Eigen::MatrixXd phi = basis_.middleRows(Eigen::Index(begin), n);
    Eigen::MatrixXd phi_phi(n, J * J);
    for (Eigen::Index j = 0; j < J; ++j)
      phi_phi.middleCols(j * J, J) = phi.array().colwise() * phi.col(j).array();
    Eigen::MatrixXd XU = Eigen::MatrixXd::Zero(P * R, n), UU = Eigen::MatrixXd::Zero(R * R, n);
    Eigen::MatrixXd Uz = Eigen::MatrixXd::Zero(R, n);
    for (std::size_t k = begin; k < end; ++k) {
      const int count = rows_.Rows(k), first = rows_.first_row[k];
      const auto at = Eigen::Index(k - begin);
      const Eigen::MatrixXd& U = rows_.units[k];
      const Eigen::MatrixXd UU_k = U.transpose() * U;
      const Eigen::MatrixXd XU_k = rows_.X.middleRows(first, count).transpose() * U;
      const Eigen::VectorXd Uz_k = U.transpose() * z.segment(first - rows_.first_row[begin], count);
      for (int a = 0; a < count; ++a) {
        const Eigen::Index row = row_place_[rows_.rows[k][a]];
        XU.block(row * P, at, P, 1) = XU_k.col(a);
        Uz(row, at) = Uz_k[a];
        for (int b = a; b < count; ++b) UU(row * R + row_place_[rows_.rows[k][b]], at) = UU_k(a, b);
      }
    }
    const Eigen::MatrixXd XU_phi = XU * phi, UU_phi = UU * phi_phi, Uz_phi = Uz * phi;
    for (Eigen::Index a = 0; a < R; ++a) {
      sums.g.segment(P + a * J, J) = Uz_phi.row(a);
      sums.H.block(0, P + a * J, P, J) = XU_phi.middleRows(a * P, P);
      for (Eigen::Index b = a; b < R; ++b)
        sums.H.block(P + a * J, P + b * J, J, J) = UU_phi.row(a * R + b).reshaped(J, J);
    }
  }

  const Eigen::VectorXd& theta_;
  const WhitenedRows& rows_;
  const Eigen::MatrixXd& basis_;
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
