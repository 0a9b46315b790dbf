#include "diagnosis/replay.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

// Standard deviations of an unknown tip force in units of EI / L^2. Across the shaft so wide that
// it prefers no force to another; along the shaft, where the force hardly shows, narrow enough to
// keep it from running away.
constexpr double kAcrossPrior = 20.0, kAlongPrior = 1.0;
constexpr double kAlongOverAcross = 1.5, kLeastAlong = 0.05;
constexpr double kMaxForceStep = 0.5;  // in the same units
constexpr int kForceSteps = 15;
constexpr double kForceRest = 1e-3;          // fall of the squared residual that is worth a step
constexpr std::size_t kForceNeighbours = 4;  // on either side, that say what a force should be
constexpr std::size_t kSharedNoise = 8;      // samples over which smoothed loads share their noise
constexpr int kAlikeReach = 4;
constexpr double kBadFit = 3.0;     // against the neighbour's, that looks like a wrong minimum
constexpr std::size_t kChunk = 64;  // samples solved one after the other, each from the last

/// Calls `work(k)` for every sample, chunk by chunk in parallel; `make` makes a chunk's context.
template <class Work>
void ForChunks(std::size_t count, Work work) {
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks, 1), [&](const auto& range) {
    for (std::size_t c = range.begin(); c < range.end(); ++c)
      work(c * kChunk, std::min(count, (c + 1) * kChunk));
  });
}

std::vector<int> UsedRows(const DiagnosisSample& sample, const std::bitset<row::kCount>& used) {
  std::vector<int> rows;
  for (int r = 0; r < row::kCount; ++r)
    if (sample.present[r] && used[r]) rows.push_back(r);
  return rows;
}

}  // namespace

/// Covariance and mean of one sample's rows: residual - mean has covariance `covariance`; the force
/// explains `by_force` times its distance from its prior.
struct Replay::Statistics {
  std::vector<int> rows;
  Eigen::VectorXd e;  // with the force at its prior
  Eigen::MatrixXd by_force;
  Eigen::Matrix3d force_prior;
  Eigen::LLT<Eigen::MatrixXd> covariance;

  /// The force's most likely distance from its prior.
  Eigen::Vector3d Force(const Eigen::VectorXd& residual) const {
    return force_prior * by_force.transpose() * covariance.solve(residual);
  }
};

Replay::Replay(const SampleSet& samples, const ParameterLayout& layout)
    : samples_(samples),
      layout_(layout),
      retiming_(samples),
      force_unit_N_(samples.instrument.bending_stiffness_Nm2 / samples.instrument.length_m /
                    samples.instrument.length_m),
      theta_(Eigen::VectorXd::Zero(layout.Size())),
      replayed_(samples.samples.size()),
      along_prior_(kAlongPrior) {
  noise_scale_.fill(1.0);
  if (!samples.has_load) return;
  for (std::size_t k = 0; k < replayed_.size(); ++k)
    replayed_[k].f_tip_N = samples.samples[k].f_tip_N;
}

bool Replay::Evaluate(const Eigen::VectorXd& theta) {
  if (samples_.has_load) return EvaluateWithForces(theta);
  theta_ = theta;
  ApplyEffects(theta);
  Retime();
  FitForces();
  return Finish();
}

bool Replay::EvaluateWithForces(const Eigen::VectorXd& theta) {
  theta_ = theta;
  ApplyEffects(theta);
  Retime();
  SolveRods();
  return Finish();
}

bool Replay::Finish() {
  failed_ = int(std::count_if(replayed_.begin(), replayed_.end(),
                              [](const ReplayedSample& s) { return !s.ok; }));
  if (failed_ * 10 > int(replayed_.size())) return false;
  CompareSamples();
  return true;
}

bool Replay::Settle(const Eigen::VectorXd& theta) { return Evaluate(theta) && Evaluate(theta); }

void Replay::ApplyEffects(const Eigen::VectorXd& theta) {
  std::vector<EffectMemory> memory(layout_.Blocks().size());
  for (auto& m : memory) m.fill(0.0);
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    ReplayedSample& sample = replayed_[k];
    Moment now{samples_, k, samples_.samples[k].t_s, 0.0, 0.0};
    if (sample.ok) {
      now.ds_port_dfriction_m = sample.solved.ds_port_dfriction_m;
      now.s_port_free_m = sample.solved.s_port_m -
                          now.ds_port_dfriction_m * sample.inputs[model_input::kPortFriction];
    }
    sample.inputs.setZero();
    sample.columns.clear();
    for (std::size_t b = 0; b < layout_.Blocks().size(); ++b) {
      const auto& block = layout_.Blocks()[b];
      InputChange change(theta.data() + block.first, block.first, sample.inputs, sample.columns);
      block.effect->Apply(theta.data() + block.first, now, memory[b], change);
    }
  }
}

void Replay::SolveRods() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    EffectRodSolver solver;
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      sample.solved = SolveSample(samples_, k, sample.inputs, sample.f_tip_N, solver);
      sample.ok = sample.solved.ok;
    }
  });
}

void Replay::Retime() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      replayed_[k].measured = retiming_.At(k, replayed_[k].inputs[model_input::kEmDelay],
                                           replayed_[k].inputs[model_input::kCameraDelay]);
  });
}

/// Replays sample `k` with the force `f_N`; false where that has no equilibrium, with nothing
/// changed.
bool Replay::TryForce(std::size_t k, const Eigen::Vector3d& f_N, EffectRodSolver& solver) {
  ReplayedSample& sample = replayed_[k];
  const SolvedSample solved = SolveSample(samples_, k, sample.inputs, f_N, solver);
  if (!solved.ok) return false;
  sample.solved = solved;
  sample.ok = true;
  sample.f_tip_N = f_N;
  sample.compared = Compare(samples_, sample.measured, sample.inputs, f_N,
                            {solved.at, Geometry::Zero(), Geometry::Zero()}, solved.by_inputs);
  return true;
}

/// Levenberg-Marquardt on one sample's force: its own residuals and the force's prior.
void Replay::FitForce(std::size_t k, EffectRodSolver& solver) {
  ReplayedSample& sample = replayed_[k];
  const auto rows = UsedRows(samples_.samples[k], AllRows());
  if (!TryForce(k, sample.f_tip_N, solver) && !TryForce(k, Eigen::Vector3d::Zero(), solver)) {
    sample.ok = false;
    return;
  }
  if (rows.empty()) return;
  const Eigen::LLT<Eigen::MatrixXd> noise(OwnCovariance(k, rows));
  const Eigen::Matrix3d precision = ForcePrior(k).inverse();
  const double unit_N = ForceUnit(k);
  const auto residual = [&] { return Eigen::VectorXd(sample.compared.residual(rows)); };
  const Eigen::Vector3d mean_N = MeanForce(k);
  const auto merit = [&] {
    const Eigen::Vector3d off = sample.f_tip_N - mean_N;
    return noise.matrixL().solve(residual()).squaredNorm() + off.dot(precision * off);
  };
  double damping = 0.0;
  sample.force_merit = merit();
  for (int i = 0; i < kForceSteps; ++i) {
    const Eigen::MatrixXd B = sample.compared.by_inputs(rows, Eigen::seqN(model_input::kForce, 3));
    const Eigen::Matrix3d H = B.transpose() * noise.solve(B) + precision;
    const Eigen::Vector3d g =
        B.transpose() * noise.solve(residual()) - precision * (sample.f_tip_N - mean_N);
    const Eigen::Matrix3d damped = H + damping * (H.trace() / 3.0) * Eigen::Matrix3d::Identity();
    Eigen::Vector3d step = damped.llt().solve(g);
    if (step.norm() > kMaxForceStep * unit_N) step *= kMaxForceStep * unit_N / step.norm();
    if (step.dot(g) < kForceRest) return;
    const ReplayedSample before = sample;
    const double now =
        TryForce(k, sample.f_tip_N + step, solver) ? merit() : before.force_merit + 1.0;
    if (now < before.force_merit) {
      sample.force_merit = now;
      damping *= 0.1;
    } else {
      sample = before;
      damping = std::max(1e-4, 10.0 * damping);
    }
  }
}

/// The sample next to `k` with the same sensors, `step` of -1 or 1 at a time; `k` where there is
/// none near.
std::size_t Replay::NextAlike(std::size_t k, int step) const {
  for (int i = 1; i <= kAlikeReach; ++i) {
    const auto j = std::ptrdiff_t(k) + step * i;
    if (j < 0 || j >= std::ptrdiff_t(replayed_.size())) break;
    if (replayed_[j].ok && samples_.samples[j].present == samples_.samples[k].present)
      return std::size_t(j);
  }
  return k;
}

/// Refits sample `k` from the force and the shape of one next to it where its own fit looks like a
/// wrong minimum.
void Replay::MendForce(std::size_t k) {
  for (const int step : {-1, 1}) {
    const std::size_t next = NextAlike(k, step);
    const double rows = double(samples_.samples[k].present.count());
    if (next == k || (replayed_[k].ok &&
                      replayed_[k].force_merit < kBadFit * (replayed_[next].force_merit + rows)))
      continue;
    const ReplayedSample own = replayed_[k];
    EffectRodSolver solver;
    SolveSample(samples_, next, replayed_[next].inputs, replayed_[next].f_tip_N, solver);
    replayed_[k].f_tip_N = replayed_[next].f_tip_N;
    FitForce(k, solver);
    if (own.ok && (!replayed_[k].ok || own.force_merit < replayed_[k].force_merit))
      replayed_[k] = own;
  }
}

/// Each sample from where it was; where that ends badly, from its neighbours' force.
void Replay::FitForces() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    EffectRodSolver solver;
    for (std::size_t k = begin; k < end; ++k) FitForce(k, solver);
  });
  for (std::size_t k = 0; k < replayed_.size(); ++k) MendForce(k);
}

/// Rate and bend by the least-squares parabola through two samples on either side.
TimedGeometry Replay::WithRate(std::size_t k) const {
  TimedGeometry timed{replayed_[k].solved.at, Geometry::Zero(), Geometry::Zero()};
  const std::size_t n = replayed_.size();
  if (!samples_.resolved_in_time || n < 5) return timed;
  const std::size_t first = std::clamp<std::size_t>(k, 2, n - 3) - 2;
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, place::kCount> rhs;
  rhs.setZero();
  for (std::size_t a = first; a < first + 5; ++a) {
    if (!replayed_[a].ok) return timed;
    const double u = (samples_.samples[a].t_s - samples_.samples[k].t_s) / samples_.period_s;
    const Eigen::Vector3d basis(1.0, u, 0.5 * u * u);
    N += basis * basis.transpose();
    rhs += basis * replayed_[a].solved.at.transpose();
  }
  const Eigen::Matrix<double, 3, place::kCount> fit = N.inverse() * rhs;
  timed.rate = fit.row(1).transpose() / samples_.period_s;
  timed.bend = fit.row(2).transpose() / (samples_.period_s * samples_.period_s);
  return timed;
}

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

void Replay::TakeSettings(const Replay& other) {
  noise_scale_ = other.noise_scale_;
  along_prior_ = other.along_prior_;
}

void Replay::AdaptForcePrior() {
  std::vector<double> across;
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    if (!replayed_[k].ok) continue;
    const Eigen::Vector3d t = (samples_.p_RP - samples_.samples[k].p_RW).normalized();
    const Eigen::Vector3d f = replayed_[k].f_tip_N;
    across.push_back((f - f.dot(t) * t).norm() / ForceUnit(k) / std::sqrt(2.0));
  }
  if (samples_.has_load || across.empty()) return;
  double squares = 0.0;
  for (const double f : across) squares += f * f / double(across.size());
  along_prior_ = std::max(kLeastAlong, kAlongOverAcross * std::sqrt(squares));
}

/// What samples around `k` say, on the mean: with as many before as after it, without itself and
/// those that share its noise. Itself where there are none.
template <class Get>
auto Replay::Around(std::size_t k, Get get) const {
  using Value = std::decay_t<decltype(get(k))>;
  const std::size_t skip = samples_.has_load ? kSharedNoise : 0;
  const std::size_t reach = std::min({k, replayed_.size() - 1 - k, skip + kForceNeighbours});
  const Value own = get(k);
  if (!samples_.resolved_in_time || own_derivatives_) return own;
  Value sum = Value::Zero();
  int count = 0;
  for (std::size_t by = skip + 1; by <= reach; ++by) {
    if (!replayed_[k - by].ok || !replayed_[k + by].ok) continue;
    sum += get(k - by) + get(k + by);
    count += 2;
  }
  return count == 0 ? own : Value(sum / count);
}

/// The geometry's derivatives, those by compliances and by stiffness (with the force in its units)
/// as the samples around have them: they grow with the force, and the noise of a force found from
/// this very sample must not look like something explained.
GeometryByInputs Replay::ExpectedDerivatives(std::size_t k) const {
  GeometryByInputs by = replayed_[k].solved.by_inputs;
  for (const int input : {rod_input::kPortCompliance, rod_input::kWristCompliance})
    by.col(input) = Around(
        k, [&](std::size_t j) -> Geometry { return replayed_[j].solved.by_inputs.col(input); });
  const auto with_force = [&](std::size_t j) -> Geometry {
    const GeometryByInputs& own = replayed_[j].solved.by_inputs;
    if (samples_.has_load) return own.col(rod_input::kStiffness);
    return own.col(rod_input::kStiffness) +
           own.middleCols<3>(rod_input::kForce) * replayed_[j].f_tip_N;
  };
  by.col(rod_input::kStiffness) += Around(k, with_force) - with_force(k);
  return by;
}

void Replay::CompareSamples() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      if (!sample.ok) continue;
      const Eigen::Vector3d expected_N =
          Around(k, [&](std::size_t j) -> Eigen::Vector3d { return replayed_[j].f_tip_N; });
      sample.compared =
          Compare(samples_, sample.measured, sample.inputs, ForceOnTip(sample.f_tip_N, expected_N),
                  WithRate(k), ExpectedDerivatives(k));
      for (int i = 0; i < 4; ++i) {  // a gain acts on the moment, which comes of the force too
        if (!sample.measured.Has(row::kStrain + i)) continue;
        const auto moment = Around(k, [&](std::size_t j) -> Eigen::Matrix<double, 1, 1> {
          return replayed_[j].solved.at.segment<1>(place::kMoments + i);
        });
        sample.compared.by_inputs(row::kStrain + i, model_input::kStrainGain + i) = moment[0];
      }
    }
  });
}

/// Mean of the tip's force before the sensors say anything of it.
Eigen::Vector3d Replay::MeanForce(std::size_t k) const {
  if (samples_.has_load) return samples_.samples[k].f_tip_N;
  return replayed_[k].inputs.segment<3>(model_input::kForce);
}

/// Covariance of the tip's force.
Eigen::Matrix3d Replay::ForcePrior(std::size_t k) const {
  if (samples_.has_load)
    return std::pow(samples_.samples[k].force_noise_N, 2) * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d t = (samples_.p_RP - samples_.samples[k].p_RW).normalized();
  const double unit = ForceUnit(k);
  const double across = std::pow(kAcrossPrior * unit, 2), along = std::pow(along_prior_ * unit, 2);
  return across * Eigen::Matrix3d::Identity() + (along - across) * t * t.transpose();
}

/// EI / L^2 of the shaft as the replay has it.
double Replay::ForceUnit(std::size_t k) const {
  return force_unit_N_ * std::exp(replayed_[k].inputs[model_input::kStiffness]);
}

Replay::Statistics Replay::StatisticsOf(std::size_t k,
                                        const std::bitset<row::kCount>& rows_used) const {
  const ReplayedSample& sample = replayed_[k];
  Statistics s;
  if (sample.ok) s.rows = UsedRows(samples_.samples[k], rows_used);
  const auto n = Eigen::Index(s.rows.size());
  s.e.resize(n);
  s.by_force.resize(n, 3);
  Eigen::MatrixXd by_wrist(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    s.e[i] = sample.compared.residual[s.rows[i]];
    s.by_force.row(i) = sample.compared.by_inputs.block<1, 3>(s.rows[i], model_input::kForce);
    by_wrist.row(i) = sample.compared.by_inputs.block<1, 3>(s.rows[i], model_input::kWrist);
  }
  s.force_prior = ForcePrior(k);
  s.e += s.by_force * (sample.f_tip_N - MeanForce(k));
  const double wrist_m = samples_.samples[k].p_RW_noise_m;
  Eigen::MatrixXd C = OwnCovariance(k, s.rows);
  C += wrist_m * wrist_m * by_wrist * by_wrist.transpose();
  C += s.by_force * s.force_prior * s.by_force.transpose();
  s.covariance.compute(C);
  return s;
}

/// An unknown force is one in units of EI / L^2: a stiffer shaft comes with a larger force, and
/// shape alone says nothing of either.
double Replay::ByInput(std::size_t k, int r, int input) const {
  const ReplayedSample& sample = replayed_[k];
  double value = sample.compared.by_inputs(r, input);
  if (input == model_input::kStiffness && !samples_.has_load)
    value += sample.compared.by_inputs.block<1, 3>(r, model_input::kForce).dot(sample.f_tip_N);
  return value;
}

Eigen::MatrixXd Replay::Derivatives(std::size_t k, const std::vector<int>& rows) const {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()), layout_.Size());
  for (const auto& column : replayed_[k].columns)
    for (std::size_t i = 0; i < rows.size(); ++i)
      A(Eigen::Index(i), column.parameter) += column.value * ByInput(k, rows[i], column.input);
  return A;
}

WhitenedRows Replay::Whiten(const std::bitset<row::kCount>& rows_used) const {
  WhitenedRows all;
  all.first_row.assign(1, 0);
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    const int rows = replayed_[k].ok ? int((samples_.samples[k].present & rows_used).count()) : 0;
    all.first_row.push_back(all.first_row.back() + rows);
  }
  all.e.resize(all.first_row.back());
  all.units.resize(replayed_.size());
  all.force_share.assign(replayed_.size(), 0.0);
  all.log_determinant.assign(replayed_.size(), 0.0);
  all.rows.resize(replayed_.size());
  all.X.resize(all.first_row.back(), layout_.Size());
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (all.Rows(k) == 0) continue;
      const Statistics s = StatisticsOf(k, rows_used);
      const auto L = s.covariance.matrixL();
      const auto diagonal = s.covariance.matrixLLT().diagonal();
      all.log_determinant[k] = 2.0 * diagonal.array().log().sum();
      const Eigen::MatrixXd by_force = L.solve(s.by_force);
      all.force_share[k] = (by_force.transpose() * by_force * s.force_prior).trace();
      all.e.segment(all.first_row[k], all.Rows(k)) = L.solve(s.e);
      all.X.middleRows(all.first_row[k], all.Rows(k)) = L.solve(Derivatives(k, s.rows));
      const Rows sd = RowNoise(k);
      Eigen::MatrixXd units = Eigen::MatrixXd::Zero(all.Rows(k), all.Rows(k));
      for (int i = 0; i < all.Rows(k); ++i) units(i, i) = sd[s.rows[i]];
      all.units[k] = L.solve(units);
      all.rows[k] = s.rows;
    }
  });
  return all;
}

void Replay::PredictForces(const Eigen::VectorXd& dtheta) {
  if (samples_.has_load) return;
  const int stiffness = layout_.Find("stiffness");
  const double stiffer = stiffness < 0 ? 1.0 : std::exp(dtheta[layout_.Blocks()[stiffness].first]);
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      if (!sample.ok) continue;
      const Statistics s = StatisticsOf(k, AllRows());
      if (s.rows.empty()) continue;
      Eigen::Vector3d step =
          MeanForce(k) + s.Force(s.e - Derivatives(k, s.rows) * dtheta) - sample.f_tip_N;
      for (const auto& column : sample.columns)
        if (column.input >= model_input::kForce && column.input < model_input::kForce + 3)
          step[column.input - model_input::kForce] += column.value * dtheta[column.parameter];
      const double limit = kMaxForceStep * ForceUnit(k);
      if (step.norm() > limit) step *= limit / step.norm();
      sample.f_tip_N = (sample.f_tip_N + step) * stiffer;
    }
  });
}

std::vector<Eigen::Vector3d> Replay::Forces() const {
  std::vector<Eigen::Vector3d> forces;
  for (const ReplayedSample& sample : replayed_) forces.push_back(sample.f_tip_N);
  return forces;
}

void Replay::SetForces(const std::vector<Eigen::Vector3d>& forces_N) {
  for (std::size_t k = 0; k < replayed_.size(); ++k) replayed_[k].f_tip_N = forces_N[k];
}

std::vector<Rows> Replay::ForceFreeResiduals(const std::bitset<row::kCount>& hidden,
                                             const Eigen::VectorXd& dtheta) const {
  std::vector<Rows> free(replayed_.size(), Rows::Zero());
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (!replayed_[k].ok) continue;
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

}  // namespace flextip
