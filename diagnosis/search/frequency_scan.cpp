#include "diagnosis/search/frequency_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr double kLowest_hz = 0.08, kHighest_hz = 0.7;
using Six = Eigen::Matrix<double, Eigen::Dynamic, 6>;

}  // namespace

double BestPortFrequency(const Replay& replay) {
  const WhitenedRows rows = replay.Whiten();
  const SampleSet& set = replay.Set();
  const auto N = rows.e.size();
  // What the port's position does to each whitened row.
  Eigen::MatrixXd port = Eigen::MatrixXd::Zero(N, 3);
  for (std::size_t k = 0; k < set.samples.size(); ++k) {
    for (int i = 0; i < rows.Rows(k); ++i) {
      const int r = rows.rows[k][i];
      const double sd = replay.RowNoise(k)[r];
      port.middleRows(rows.first_row[k], rows.Rows(k)) +=
          rows.units[k].col(i) *
          replay.Samples()[k].compared.by_inputs.block<1, 3>(r, model_input::kPort) / sd;
    }
  }
  Eigen::VectorXd sd = replay.Layout().Tolerances();
  // What moves with an earlier frequency is to be found again.
  const int own = replay.Layout().Find("port_motion");
  if (own >= 0) {
    const auto& block = replay.Layout().Blocks()[own];
    sd.segment(block.first, block.size).setZero();
  }
  const Eigen::MatrixXd X = rows.X * sd.asDiagonal();
  Eigen::MatrixXd M = X.transpose() * X;
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::VectorXd z = rows.e + rows.X * replay.Theta();
  const Eigen::VectorXd left = z - X * llt.Solve(X.transpose() * z);

  // Steps of a quarter of the resolution.
  const double step_hz = 0.25 / std::max(set.Duration(), 1.0);
  const int count = std::max(2, int((kHighest_hz - kLowest_hz) / step_hz));
  std::vector<double> score(count, 0.0);
  tbb::parallel_for(0, count, [&](int f) {
    const double omega = 2.0 * std::numbers::pi * (kLowest_hz + f * step_hz);
    Six B(N, 6);
    for (std::size_t k = 0; k < set.samples.size(); ++k) {
      const double angle = omega * set.samples[k].t_s;
      const auto block = port.middleRows(rows.first_row[k], rows.Rows(k));
      B.middleRows(rows.first_row[k], rows.Rows(k)).leftCols<3>() = std::sin(angle) * block;
      B.middleRows(rows.first_row[k], rows.Rows(k)).rightCols<3>() = std::cos(angle) * block;
    }
    const Eigen::MatrixXd XB = X.transpose() * B;
    Eigen::MatrixXd A = B.transpose() * B - XB.transpose() * llt.Solve(XB);
    A.diagonal().array() += 1e-9 * A.trace() + 1e-12;
    const Eigen::VectorXd b = B.transpose() * left;
    score[f] = b.dot(Eigen::VectorXd(Llt(A).Solve(b)));
  });
  const auto best = std::max_element(score.begin(), score.end()) - score.begin();
  return kLowest_hz + double(best) * step_hz;
}

}  // namespace flextip::diagnosis
