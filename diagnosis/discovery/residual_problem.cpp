#include "diagnosis/discovery/residual_problem.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kMostSamples = 2500;
constexpr double kFreely = 1000.0;  // standard deviations of every row

/// Which of `count` samples are used: all, or one of each equal stretch.
std::vector<bool> Picked(std::size_t count) {
  std::vector<bool> picked(count, count <= kMostSamples);
  if (count <= kMostSamples) return picked;
  std::mt19937_64 rng(11);
  for (std::size_t i = 0; i < kMostSamples; ++i) {
    const std::size_t from = count * i / kMostSamples, to = count * (i + 1) / kMostSamples;
    picked[from + std::uniform_int_distribution<std::size_t>(0, to - from - 1)(rng)] = true;
  }
  return picked;
}

}  // namespace

ResidualProblem::ResidualProblem(const Replay& replay, const Eigen::VectorXd& prior_sd, int blocks)
    : replay_(&replay), rows_(replay.Whiten()) {
  const std::size_t n = replay.Samples().size();
  const std::vector<bool> picked = Picked(n);
  int rows = 0;
  for (std::size_t k = 0; k < n; ++k) {
    sample_row_.push_back(rows);
    if (!picked[k]) rows_.rows[k].clear();
    rows += static_cast<int>(rows_.rows[k].size());
    if (!rows_.rows[k].empty()) ++samples_used_;
  }
  sample_row_.push_back(rows);
  const Eigen::VectorXd z = rows_.e + rows_.X * replay.Theta();
  X_.resize(rows, prior_sd.size());
  z_.resize(rows);
  here_.resize(rows);
  for (std::size_t k = 0; k < n; ++k) {
    const auto count = static_cast<Eigen::Index>(rows_.rows[k].size());
    X_.middleRows(sample_row_[k], count) =
        rows_.X.middleRows(rows_.first_row[k], count) * prior_sd.asDiagonal();
    here_.segment(sample_row_[k], count) = rows_.e.segment(rows_.first_row[k], count);
    z_.segment(sample_row_[k], count) = z.segment(rows_.first_row[k], count);
  }
  for (int b = 0; b <= blocks; ++b)
    first_row_.push_back(
        sample_row_[n * static_cast<std::size_t>(b) / static_cast<std::size_t>(blocks)]);
  squares_.resize(static_cast<std::size_t>(blocks));
  SumSquares();
}

void ResidualProblem::SumSquares() {
  for (int b = 0; b < Blocks(); ++b) {
    const auto X = X_.middleRows(FirstRow(b), FirstRow(b + 1) - FirstRow(b));
    squares_[static_cast<std::size_t>(b)] = X.transpose() * X;
  }
}

int ResidualProblem::BlockOf(std::size_t k) const {
  const auto after = std::upper_bound(first_row_.begin() + 1, first_row_.end() - 1, sample_row_[k]);
  return static_cast<int>(after - first_row_.begin()) - 1;
}

Eigen::MatrixXd ResidualProblem::ByTarget(TermTarget target) const {
  const TermTargetInfo& info = InfoOf(target);
  const bool known_load = replay_->Set().has_load;
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(z_.size(), info.inputs);
  for (std::size_t k = 0; k < rows_.rows.size(); ++k) {
    const auto& rows = rows_.rows[k];
    if (rows.empty()) continue;
    const ReplayedSample& sample = replay_->Samples()[k];
    const Rows sd = replay_->RowNoise(k);
    Eigen::MatrixXd by(rows.size(), info.inputs);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Eigen::RowVectorXd one =
          sample.compared.by_inputs.row(rows[i]).segment(info.first_input, info.inputs);
      if (target == TermTarget::kStiffness && !known_load)  // with the force in its units
        one[0] += sample.compared.by_inputs.block<1, 3>(rows[i], sample_input::kForce)
                      .dot(sample.f_tip_N);
      by.row(Eigen::Index(i)) = info.sign / sd[rows[i]] * one;
    }
    B.middleRows(sample_row_[k], Eigen::Index(rows.size())) = rows_.units[k] * by;
  }
  return B;
}

Eigen::MatrixXd ResidualProblem::Moved(const Term& term, const TermSeries& series,
                                       bool offset) const {
  const Eigen::MatrixXd B = ByTarget(term.target);
  const Eigen::Index n = B.cols(), columns = term.Columns();
  Eigen::MatrixXd moved(B.rows(), n * columns + (offset ? n : 0));
  for (std::size_t k = 0; k < rows_.rows.size(); ++k) {
    const int first = sample_row_[k], count = sample_row_[k + 1] - first;
    for (Eigen::Index j = 0; j < columns; ++j)
      for (Eigen::Index i = 0; i < n; ++i)
        moved.block(first, j * n + i, count, 1) =
            B.block(first, i, count, 1) * series(Eigen::Index(k), term.IsByInput() ? j * n + i : j);
  }
  if (offset) moved.rightCols(n) = B;
  return moved;
}

void ResidualProblem::Free(const Eigen::MatrixXd& columns) {
  const Eigen::Index before = X_.cols();
  X_.conservativeResize(Eigen::NoChange, before + columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double norm = columns.col(j).norm();
    const double scale = norm > 0.0 ? kFreely * std::sqrt(double(z_.size())) / norm : 0.0;
    X_.col(before + j) = scale * columns.col(j);
  }
  SumSquares();
}

std::vector<TermState> StatesOf(const Replay& replay, TermTarget target) {
  const SampleSet& set = replay.Set();
  std::vector<TermState> states;
  EffectMemory memory{};
  for (std::size_t k = 0; k < set.samples.size(); ++k) {
    const ReplayedSample& sample = replay.Samples()[k];
    const Instant now{set, k, set.samples[k].t_s, 0.0, 0.0, sample.ok ? &sample.solved : nullptr};
    states.push_back(StateAt(target, now, memory));
    if (!set.has_load) states.back().scalar[5] = sample.f_tip_N.norm();
  }
  return states;
}

TermSeries SeriesOf(const Term& term, const std::vector<TermState>& states) {
  const Eigen::Index n = term.IsByInput() ? term.Inputs() : 1, columns = term.Columns();
  TermSeries series(Eigen::Index(states.size()), n * columns);
  EffectMemory memory{};
  for (std::size_t k = 0; k < states.size(); ++k) {
    const TermColumns at = ColumnsAt(term, states[k], memory, true);
    for (Eigen::Index j = 0; j < columns; ++j)
      for (Eigen::Index i = 0; i < n; ++i) series(Eigen::Index(k), j * n + i) = at(i, j);
  }
  return series;
}

}  // namespace flextip::diagnosis
