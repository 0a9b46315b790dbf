#include "diagnosis/discovery/target_scan.h"

#include <cmath>
#include <utility>

namespace flextip::diagnosis {
namespace {

constexpr double kFreely = 1000.0;  // standard deviations of every row

Eigen::VectorXd SolveNormal(Eigen::MatrixXd A, const Eigen::VectorXd& b) {
  A.diagonal().array() += 1e-10 * A.trace() + 1e-300;
  return Llt(A).Solve(b);
}

}  // namespace

WeightedProblem::WeightedProblem(const ResidualProblem& residual, std::vector<double> weights)
    : problem(residual), weight(std::move(weights)) {
  const Eigen::MatrixXd& X = problem.Derivatives();
  information = Eigen::MatrixXd::Identity(X.cols(), X.cols());
  right = Eigen::VectorXd::Zero(X.cols());
  double squares = 0.0;
  for (int b = 0; b < problem.Blocks(); ++b) {
    const double w = weight[static_cast<std::size_t>(b)];
    if (w == 0.0) continue;
    const int first = problem.FirstRow(b), count = problem.FirstRow(b + 1) - first;
    const auto z = problem.Left().segment(first, count);
    information += w * problem.Squares(b);
    right += w * (X.middleRows(first, count).transpose() * z);
    squares += w * z.squaredNorm();
    rows += w * count;
    samples += w * problem.SamplesUsed() / double(problem.Blocks());
  }
  cost = squares - right.dot(Eigen::VectorXd(Llt(information).Solve(right)));
}

TargetScan::TargetScan(const WeightedProblem& weighted, TermTarget target, bool offset)
    : weighted_(weighted), inputs_(InfoOf(target).inputs), offset_(offset) {
  const ResidualProblem& problem = weighted.problem;
  const Eigen::MatrixXd B = problem.ByTarget(target);
  const Eigen::MatrixXd& X = problem.Derivatives();
  const Eigen::VectorXd& z = problem.Left();
  const Eigen::Index P = X.cols(), n = inputs_, all = P + (offset ? n : 0);
  Eigen::VectorXd row_weight(z.size());
  for (int b = 0; b < problem.Blocks(); ++b)
    row_weight.segment(problem.FirstRow(b), problem.FirstRow(b + 1) - problem.FirstRow(b))
        .setConstant(weighted.weight[static_cast<std::size_t>(b)]);
  const Eigen::MatrixXd weighted_B = row_weight.asDiagonal() * B;
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(all, all);
  M.topLeftCorner(P, P) = weighted.information;
  right_.resize(all);
  right_.head(P) = weighted.right;
  offset_scale_ = Eigen::VectorXd::Zero(n);
  if (offset) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const double norm = B.col(i).norm();
      offset_scale_[i] = norm > 0.0 ? kFreely * std::sqrt(double(z.size())) / norm : 0.0;
    }
    const Eigen::MatrixXd border = X.transpose() * weighted_B * offset_scale_.asDiagonal();
    M.topRightCorner(P, n) = border;
    M.bottomLeftCorner(n, P) = border.transpose();
    M.bottomRightCorner(n, n) +=
        offset_scale_.asDiagonal() * (B.transpose() * weighted_B) * offset_scale_.asDiagonal();
    right_.tail(n) = offset_scale_.asDiagonal() * (weighted_B.transpose() * z);
  }
  llt_ = std::make_unique<Llt<Eigen::Dynamic>>(M);
  const Eigen::VectorXd x = llt_->Solve(right_);
  cost_ = weighted.cost +
          weighted.right.dot(Eigen::VectorXd(Llt(weighted.information).Solve(weighted.right))) -
          right_.dot(x);
  Eigen::VectorXd left = z - X * x.head(P);
  if (offset) left -= B * (offset_scale_.asDiagonal() * x.tail(n));
  const std::size_t samples = problem.Of().Samples().size();
  with_left_ = Eigen::MatrixXd::Zero(Eigen::Index(samples), n);
  with_self_ = Eigen::MatrixXd::Zero(Eigen::Index(samples), n * n);
  with_X_.assign(static_cast<std::size_t>(n), Eigen::MatrixXd::Zero(all, Eigen::Index(samples)));
  for (std::size_t k = 0; k < samples; ++k) {
    const int first = problem.FirstRowOfSample(k), count = problem.FirstRowOfSample(k + 1) - first;
    if (count == 0 || row_weight[first] == 0.0) continue;
    const auto b = B.middleRows(first, count);
    const auto wb = weighted_B.middleRows(first, count);
    const auto at = Eigen::Index(k);
    const Eigen::MatrixXd self = wb.transpose() * b;
    with_left_.row(at) = (wb.transpose() * left.segment(first, count)).transpose();
    with_self_.row(at) = self.reshaped().transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
      auto column = with_X_[static_cast<std::size_t>(i)].col(at);
      column.head(P) = X.middleRows(first, count).transpose() * wb.col(i);
      if (offset) column.tail(n) = offset_scale_.asDiagonal() * self.col(i);
    }
  }
}

TargetScan::Normal TargetScan::NormalOf(const Term& term, const TermSeries& series) const {
  const Eigen::Index n = inputs_, m = term.Columns(), size = n * m;
  const bool by_input = term.IsByInput();
  const auto column = [&](Eigen::Index a) {  // of amplitude a: input a % n, column a / n
    return series.col(by_input ? a : a / n);
  };
  Normal normal{Eigen::MatrixXd(size, size), Eigen::VectorXd(size)};
  if (by_input) {
    for (Eigen::Index a = 0; a < size; ++a) {
      normal.b[a] = with_left_.col(a % n).dot(column(a));
      for (Eigen::Index c = a; c < size; ++c)
        normal.A(a, c) = normal.A(c, a) =
            (with_self_.col((a % n) * n + c % n).array() * column(a).array() * column(c).array())
                .sum();
    }
    return normal;
  }
  for (Eigen::Index j = 0; j < m; ++j) {
    normal.b.segment(j * n, n) = with_left_.transpose() * series.col(j);
    for (Eigen::Index l = j; l < m; ++l) {
      const Eigen::VectorXd product = series.col(j).cwiseProduct(series.col(l));
      const Eigen::VectorXd sums = with_self_.transpose() * product;
      normal.A.block(j * n, l * n, n, n) = sums.reshaped(n, n);
      normal.A.block(l * n, j * n, n, n) = sums.reshaped(n, n).transpose();
    }
  }
  return normal;
}

double TargetScan::LeastGain(const Term& term, const TermSeries& series) const {
  const Normal normal = NormalOf(term, series);
  return normal.b.dot(SolveNormal(normal.A, normal.b));
}

double TargetScan::Gain(Term& term, const TermSeries& series) const {
  const Eigen::Index n = inputs_, size = n * term.Columns();
  term.amplitude.resize(n, term.Columns());
  Eigen::VectorXd x = right_;
  double gain = 0.0;
  if (size > 0) {
    Normal normal = NormalOf(term, series);
    Eigen::MatrixXd XC(right_.size(), size);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (term.IsByInput()) {
        for (Eigen::Index j = 0; j < term.Columns(); ++j)
          XC.col(j * n + i) = with_X_[static_cast<std::size_t>(i)] * series.col(j * n + i);
      } else {
        const Eigen::MatrixXd products = with_X_[static_cast<std::size_t>(i)] * series;
        for (Eigen::Index j = 0; j < term.Columns(); ++j) XC.col(j * n + i) = products.col(j);
      }
    }
    const Eigen::VectorXd scale = normal.A.diagonal();
    normal.A -= XC.transpose() * llt_->Solve(XC);
    // What the model can nearly take up by itself counts as nothing.
    normal.A.diagonal() += 1e-6 * scale;
    const Eigen::VectorXd a = SolveNormal(normal.A, normal.b);
    gain = normal.b.dot(a);
    term.amplitude.reshaped() = a;
    x -= XC * a;
  }
  term.offset.resize(0);
  if (offset_) term.offset = offset_scale_.asDiagonal() * llt_->Solve(x).tail(n);
  return gain;
}

}  // namespace flextip::diagnosis
