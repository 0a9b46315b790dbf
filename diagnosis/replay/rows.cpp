// What a replay leaves of the measurements, as rows of unit covariance.
#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/replay/replay.h"
#include "diagnosis/replay/sample_loops.h"

namespace flextip::diagnosis {

/// Covariance and mean of one sample's rows: residual - mean has covariance `covariance`; the force
/// explains `by_force` times its distance from its prior.
struct Replay::Statistics {
  std::vector<int> rows;
  Eigen::VectorXd e;  // with the force at its prior
  Eigen::MatrixXd by_force;
  Eigen::Matrix3d force_prior;
  Llt<Eigen::Dynamic> covariance;

  /// The force's most likely distance from its prior.
  Eigen::Vector3d Force(const Eigen::VectorXd& residual) const {
    return force_prior * by_force.transpose() * covariance.Solve(residual);
  }
};

Rows Replay::RowNoise(std::size_t k) const {
  const SensorNoises& n = samples_.noise;
  Rows sd = Rows::Zero();
  const auto fill = [&](int channel, double value) {
    sd.segment(kChannels[channel].first_row, kChannels[channel].rows)
        .setConstant(value * noise_scale_[channel]);
  };
  fill(0, n.wrist_direction_rad);
  fill(1, n.em_position_m);
  fill(2, n.em_direction_rad);
  fill(3, n.moment_Nm);
  fill(5, n.tip_direction_rad);
  fill(6, n.port_direction_rad);
  sd.segment<3>(row::kTipPosition) =
      noise_scale_[4] * samples_.samples[k].p_RE_covariance_m2.diagonal().cwiseSqrt();
  return sd;
}

Eigen::MatrixXd Replay::OwnCovariance(std::size_t k, const std::vector<int>& rows) const {
  const Rows sd = RowNoise(k);
  const auto n = Eigen::Index(rows.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  const auto is_tip = [](int r) { return r >= row::kTipPosition && r < row::kTipPosition + 3; };
  for (Eigen::Index i = 0; i < n; ++i) {
    C(i, i) = sd[rows[i]] * sd[rows[i]];
    for (Eigen::Index j = 0; j < n; ++j)
      if (i != j && is_tip(rows[i]) && is_tip(rows[j]))
        C(i, j) = noise_scale_[4] * noise_scale_[4] *
                  samples_.samples[k].p_RE_covariance_m2(rows[i] - row::kTipPosition,
                                                         rows[j] - row::kTipPosition);
  }
  return C;
}

Replay::Statistics Replay::StatisticsOf(std::size_t k,
                                        const std::bitset<row::kCount>& rows_used) const {
  const ReplayedSample& sample = replayed_[k];
  Statistics s;
  if (sample.ok) s.rows = UsedRows(samples_.samples[k], rows_used);
  const auto n = Eigen::Index(s.rows.size());
  s.e.resize(n);
  s.by_force.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    s.e[i] = sample.compared.residual[s.rows[i]];
    s.by_force.row(i) = sample.compared.by_inputs.block<1, 3>(s.rows[i], sample_input::kForce);
  }
  s.force_prior = ForcePrior(k);
  s.e += s.by_force * (sample.f_tip_N - MeanForce(k));
  if (const auto noise_N = LoadNoise(k); noise_N && !input_noise_.empty()) {
    const auto fixed = input_noise_[k].rightCols<3>() / samples_.samples[k].force_noise_N;
    s.e += (s.by_force - fixed(s.rows, Eigen::all)) * *noise_N;
  }
  const InputNoise all = input_noise_.empty() ? InputNoiseHere(k) : input_noise_[k];
  const Eigen::MatrixXd by_noise = all(s.rows, Eigen::all);
  s.covariance = Llt(OwnCovariance(k, s.rows) + by_noise * by_noise.transpose());
  return s;
}

Replay::InputNoise Replay::InputNoiseHere(std::size_t k) const {
  const auto& by_inputs = replayed_[k].compared.by_inputs;
  InputNoise noise;
  noise.leftCols<3>() =
      samples_.samples[k].p_RW_noise_m * by_inputs.middleCols<3>(sample_input::kWrist);
  noise.rightCols<3>() = by_inputs.middleCols<3>(sample_input::kForce) * Llt(ForcePrior(k)).L();
  return noise;
}

/// What a known load's own noise is in a sample, as far as the samples around say. The covariance
/// has it as FixNoiseModel found it. A shaft that yields more would have more of it in its
/// residual, and look less likely for that alone.
std::optional<Eigen::Vector3d> Replay::LoadNoise(std::size_t k) const {
  const DiagnosisSample& sample = samples_.samples[k];
  if (!samples_.has_load || sample.force_noise_N <= 0.0) return {};
  return sample.f_tip_N - sample.f_around_N;
}

/// An unknown force is one in units of EI / L^2: a stiffer shaft comes with a larger force, and
/// shape alone says nothing of either.
double Replay::ByInput(std::size_t k, int r, int input) const {
  const ReplayedSample& sample = replayed_[k];
  double value = sample.compared.by_inputs(r, input);
  if (input == sample_input::kStiffness && !samples_.has_load)
    value += sample.compared.by_inputs.block<1, 3>(r, sample_input::kForce).dot(sample.f_tip_N);
  return value;
}

Eigen::MatrixXd Replay::Derivatives(std::size_t k, const std::vector<int>& rows) const {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()), layout_.Size());
  for (const auto& column : replayed_[k].columns)
    for (std::size_t i = 0; i < rows.size(); ++i)
      A(Eigen::Index(i), column.parameter) += column.value * ByInput(k, rows[i], column.input);
  return A;
}

double Replay::ChiSquaredPerDof() const {
  const WhitenedRows rows = Whiten();
  double dof = double(rows.e.size());
  if (!samples_.has_load)
    for (const auto& of_sample : rows.rows) dof -= std::min<double>(3.0, double(of_sample.size()));
  return rows.e.squaredNorm() / std::max(1.0, dof);
}

WhitenedRows Replay::Whiten(const std::bitset<row::kCount>& rows_used) const {
  WhitenedRows all;
  all.first_row.assign(1, 0);
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    const bool is_used = replayed_[k].ok && (left_out_.empty() || !left_out_[k]);
    const int rows = is_used ? int((samples_.samples[k].present & rows_used).count()) : 0;
    all.first_row.push_back(all.first_row.back() + rows);
  }
  all.e.resize(all.first_row.back());
  all.units.resize(replayed_.size());
  all.force_share.assign(replayed_.size(), 0.0);
  all.rows.resize(replayed_.size());
  all.X.resize(all.first_row.back(), layout_.Size());
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (all.Rows(k) == 0) continue;
      const Statistics s = StatisticsOf(k, rows_used);
      const Eigen::MatrixXd by_force = s.covariance.SolveL(s.by_force);
      all.force_share[k] = (by_force.transpose() * by_force * s.force_prior).trace();
      all.e.segment(all.first_row[k], all.Rows(k)) = s.covariance.SolveL(s.e);
      all.X.middleRows(all.first_row[k], all.Rows(k)) = s.covariance.SolveL(Derivatives(k, s.rows));
      const Rows sd = RowNoise(k);
      Eigen::MatrixXd units = Eigen::MatrixXd::Zero(all.Rows(k), all.Rows(k));
      for (int i = 0; i < all.Rows(k); ++i) units(i, i) = sd[s.rows[i]];
      all.units[k] = s.covariance.SolveL(units);
      all.rows[k] = s.rows;
    }
  });
  return all;
}

void Replay::PredictForces(const Eigen::VectorXd& dtheta) {
  if (samples_.has_load) return;
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      if (!sample.ok) continue;
      const Statistics s = StatisticsOf(k, AllRows());
      if (s.rows.empty()) continue;
      Eigen::Vector3d step =
          MeanForce(k) + s.Force(s.e - Derivatives(k, s.rows) * dtheta) - sample.f_tip_N;
      double log_stiffer = 0.0;
      for (const auto& column : sample.columns) {
        const double moved = column.value * dtheta[column.parameter];
        if (column.input >= sample_input::kForce && column.input < sample_input::kForce + 3)
          step[column.input - sample_input::kForce] += moved;
        if (column.input == sample_input::kStiffness) log_stiffer += moved;
      }
      sample.f_tip_N = (sample.f_tip_N + ShortStep(k, step)) * std::exp(log_stiffer);
    }
  });
}

std::vector<Rows> Replay::ForceFreeResiduals(const std::bitset<row::kCount>& hidden,
                                             const Eigen::VectorXd& dtheta,
                                             const SampleRange& range) const {
  std::vector<Rows> free(replayed_.size(), Rows::Zero());
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (!replayed_[k].ok || !range.Holds(k)) continue;
      Statistics used = StatisticsOf(k, ~hidden), all = StatisticsOf(k, AllRows());
      if (dtheta.size() > 0) {
        used.e -= Derivatives(k, used.rows) * dtheta;
        all.e -= Derivatives(k, all.rows) * dtheta;
      }
      // A known load stays what it was measured to be.
      const Eigen::Vector3d force =
          used.rows.empty() || samples_.has_load ? Eigen::Vector3d::Zero() : used.Force(used.e);
      const Eigen::VectorXd e = all.e - all.by_force * force;
      for (std::size_t i = 0; i < all.rows.size(); ++i) free[k][all.rows[i]] = e[Eigen::Index(i)];
    }
  });
  return free;
}

}  // namespace flextip::diagnosis
