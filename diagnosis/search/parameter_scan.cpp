#include "diagnosis/search/parameter_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr double kStep = 0.25;      // of the resolution
constexpr double kSameValue = 0.6;  // of the resolution

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

}  // namespace

double BestScannedValue(const Replay& replay, int block) {
  const ScannedParameter scanned = ScannedOf(replay, block);
  const auto& own = replay.Layout().Blocks()[block];
  const WhitenedRows rows = replay.Whiten();
  const SampleSet& set = replay.Set();
  const auto N = rows.e.size();
  const int inputs = scanned.inputs;
  const Eigen::MatrixXd by_inputs = ByInputs(replay, rows, scanned);
  // The effect's own parameters at an earlier value are to be found again.
  Eigen::VectorXd sd = replay.Layout().Tolerances();
  sd.segment(own.first, own.size).setZero();
  const Eigen::MatrixXd X = rows.X * sd.asDiagonal();
  Eigen::MatrixXd M = X.transpose() * X;
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::VectorXd z = rows.e + rows.X * replay.Theta();
  const Eigen::VectorXd left = z - X * llt.Solve(X.transpose() * z);

  const double step = kStep * scanned.resolution;
  const int count = std::max(2, int((scanned.highest - scanned.lowest) / step));
  std::vector<double> score(count, 0.0);
  tbb::parallel_for(0, count, [&](int candidate) {
    const double value = scanned.lowest + candidate * step;
    Eigen::MatrixXd B(N, 2 * inputs);
    for (std::size_t k = 0; k < set.samples.size(); ++k) {
      const Instant now{set, k, set.samples[k].t_s};
      const Eigen::Vector2d shapes = own.effect->ScanShapes(value, now);
      const auto block_rows = by_inputs.middleRows(rows.first_row[k], rows.Rows(k));
      auto moved = B.middleRows(rows.first_row[k], rows.Rows(k));
      moved.leftCols(inputs) = shapes[0] * block_rows;
      moved.rightCols(inputs) = shapes[1] * block_rows;
    }
    const Eigen::MatrixXd XB = X.transpose() * B;
    Eigen::MatrixXd A = B.transpose() * B - XB.transpose() * llt.Solve(XB);
    A.diagonal().array() += 1e-9 * A.trace() + 1e-12;
    const Eigen::VectorXd b = B.transpose() * left;
    score[candidate] = b.dot(Eigen::VectorXd(Llt(A).Solve(b)));
  });
  const auto best = std::max_element(score.begin(), score.end()) - score.begin();
  return scanned.lowest + double(best) * step;
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
