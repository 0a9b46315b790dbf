// The replay's tip forces: their prior, and the fit of unknown ones sample by sample.
#include <algorithm>
#include <cmath>

#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "diagnosis/replay/replay.h"
#include "diagnosis/replay/sample_loops.h"

namespace flextip::diagnosis {
namespace {

// Standard deviation of an unknown tip force across the shaft, in units of EI / L^2: so wide that
// it prefers no force to another.
constexpr double kAcrossPrior = 20.0;
// Along the shaft, where the force hardly shows, narrow enough to keep it from running away.
constexpr double kAlongOverAcross = 1.5, kLeastAlong = 0.05;
constexpr double kMaxForceStep = 0.5;  // in the same units
constexpr int kForceSteps = 6;
// Fall of the squared residual that is worth a step; the rest is taken off to first order.
constexpr double kForceRest = 0.05;
constexpr int kAlikeReach = 4;            // samples to look for one with the same sensors
constexpr std::size_t kMendedAtMost = 8;  // one sample in so many
constexpr double kBadFit = 3.0;  // against the neighbour's, that looks like a wrong minimum
// Forces farther out than so many times those of nine samples in ten are wrong minima.
constexpr double kWildForce = 2.0;

}  // namespace

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
                            {solved.at, sample.rate, sample.bend}, solved.by_inputs);
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
  const Llt noise(OwnCovariance(k, rows));
  const Eigen::Matrix3d precision = ForcePrior(k).inverse();
  const auto residual = [&] { return Eigen::VectorXd(sample.compared.residual(rows)); };
  const Eigen::Vector3d mean_N = MeanForce(k);
  const auto merit = [&] {
    const Eigen::Vector3d off = sample.f_tip_N - mean_N;
    return noise.SolveL(residual()).squaredNorm() + off.dot(precision * off);
  };
  sample.force_merit = merit();
  const auto try_step = [&](double damping) -> TrialStep {
    const Eigen::MatrixXd B = sample.compared.by_inputs(rows, Eigen::seqN(sample_input::kForce, 3));
    const Eigen::Matrix3d H = B.transpose() * noise.Solve(B) + precision;
    const Eigen::Vector3d g =
        B.transpose() * noise.Solve(residual()) - precision * (sample.f_tip_N - mean_N);
    const Eigen::Matrix3d damped = H + damping * (H.trace() / 3.0) * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = ShortStep(k, Llt(damped).Solve(g));
    if (step.dot(g) < kForceRest) return {.cost = sample.force_merit, .settled = true};
    const ReplayedSample before = sample;
    if (TryForce(k, sample.f_tip_N + step, solver)) sample.force_merit = merit();
    if (sample.force_merit < before.force_merit) return {.cost = sample.force_merit};
    sample = before;
    return {};
  };
  const auto accept = [] {};  // the sample is where it was tried
  Descend(sample.force_merit, try_step, accept,
          {.max_iterations = kForceSteps,
           .start_damping = 0.0,
           .least_damping = 0.0,
           .floor = 0.0,
           .least_raised = 1e-4,
           .relative_gain = 0.0});
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

/// Whether the force of sample `k` looks like a wrong minimum beside that of sample `next`.
bool Replay::LooksWrong(std::size_t k, std::size_t next) const {
  if (!replayed_[k].ok) return true;
  const double rows = double(samples_.samples[k].present.count());
  return replayed_[next].ok &&
         replayed_[k].force_merit >= kBadFit * (replayed_[next].force_merit + rows);
}

/// Fits the force of sample `k` from `start_N` too, and takes the better of the two.
void Replay::FitBetter(std::size_t k, const Eigen::Vector3d& start_N, EffectRodSolver& solver) {
  const ReplayedSample own = replayed_[k];
  replayed_[k].f_tip_N = start_N;
  FitForce(k, solver);
  if (own.ok && (!replayed_[k].ok || own.force_merit < replayed_[k].force_merit))
    replayed_[k] = own;
}

/// Refits sample `k` from the force and the shape of one next to it where its own fit looks like a
/// wrong minimum; false where it does not.
bool Replay::MendForce(std::size_t k) {
  bool is_suspect = false;
  for (const int step : {-1, 1}) {
    const std::size_t next = NextAlike(k, step);
    if (next == k || !LooksWrong(k, next)) continue;
    is_suspect = true;
    EffectRodSolver solver;
    SolveSample(samples_, next, replayed_[next].inputs, replayed_[next].f_tip_N, solver);
    FitBetter(k, replayed_[next].f_tip_N, solver);
  }
  return is_suspect;
}

/// Samples that are not judged have the force of the nearest that is: how the shaft moves and
/// slides at the ends follows from their shapes, too.
void Replay::BorrowForces() {
  const auto n = std::ptrdiff_t(replayed_.size());
  const auto is_judged = [&](std::ptrdiff_t k) {
    return k >= 0 && k < n && replayed_[k].ok && samples_.samples[k].present.any();
  };
  EffectRodSolver solver;
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    if (samples_.samples[k].present.any()) continue;
    for (std::ptrdiff_t by = 1; by < n; ++by) {
      if (!is_judged(k - by) && !is_judged(k + by)) continue;
      const auto& nearest = replayed_[is_judged(k - by) ? k - by : k + by];
      replayed_[k].ok = TryForce(k, nearest.f_tip_N, solver);
      break;
    }
  }
}

/// Each sample from where it was, moved as the one before had to be; where that ends badly, from
/// its neighbours' force.
void Replay::FitForces() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    EffectRodSolver solver;
    Eigen::Vector3d moved_N = Eigen::Vector3d::Zero();
    for (std::size_t k = begin; k < end; ++k) {
      if (!replayed_[k].stale || samples_.samples[k].present.none()) continue;
      const Eigen::Vector3d before_N = replayed_[k].f_tip_N;
      replayed_[k].f_tip_N += moved_N;
      FitForce(k, solver);
      if (k > begin && !moved_N.isZero(0) && LooksWrong(k, k - 1)) FitBetter(k, before_N, solver);
      moved_N = replayed_[k].ok ? Eigen::Vector3d(replayed_[k].f_tip_N - before_N)
                                : Eigen::Vector3d::Zero();
    }
  });
  // Where many look wrong it is the parameters that are: not worth the time.
  std::size_t left = replayed_.size() / kMendedAtMost;
  for (std::size_t k = 0; k < replayed_.size() && left > 0; ++k)
    if (samples_.samples[k].present.any() && MendForce(k)) --left;
  BorrowForces();
}

void Replay::FixNoiseModel() {
  if (samples_.has_load) {
    input_noise_.clear();
    for (std::size_t k = 0; k < replayed_.size(); ++k) input_noise_.push_back(InputNoiseHere(k));
    return;
  }
  std::vector<double> across;
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    if (!replayed_[k].ok) continue;
    const Eigen::Vector3d t = (samples_.p_RP - samples_.samples[k].p_RW).normalized();
    const Eigen::Vector3d f = replayed_[k].f_tip_N - MeanForce(k);
    across.push_back((f - f.dot(t) * t).norm() / ForceUnit(k) / std::sqrt(2.0));
  }
  if (across.empty()) return;
  const double wild = kWildForce * LowerQuantile(across, 0.9);
  std::erase_if(across, [&](double f) { return f > wild; });
  double squares = 0.0;
  for (const double f : across) squares += f * f / double(across.size());
  along_prior_ = std::max(kLeastAlong, kAlongOverAcross * std::sqrt(squares));
}

/// Mean of the tip's force before the sensors say anything of it.
Eigen::Vector3d Replay::MeanForce(std::size_t k) const {
  const Eigen::Vector3d mean_N = replayed_[k].inputs.segment<3>(sample_input::kForce);
  return samples_.has_load ? Eigen::Vector3d(samples_.samples[k].f_tip_N + mean_N) : mean_N;
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
  return force_unit_N_ * std::exp(replayed_[k].inputs[sample_input::kStiffness]);
}

std::vector<Eigen::Vector3d> Replay::Forces() const {
  std::vector<Eigen::Vector3d> forces;
  for (const ReplayedSample& sample : replayed_) forces.push_back(sample.f_tip_N);
  return forces;
}

void Replay::SetForces(const std::vector<Eigen::Vector3d>& forces_N) {
  for (std::size_t k = 0; k < replayed_.size(); ++k) replayed_[k].f_tip_N = forces_N[k];
}

/// No further than a replay should go at once.
Eigen::Vector3d Replay::ShortStep(std::size_t k, const Eigen::Vector3d& step_N) const {
  const double limit_N = kMaxForceStep * ForceUnit(k);
  return step_N.norm() > limit_N ? Eigen::Vector3d(step_N * (limit_N / step_N.norm())) : step_N;
}

}  // namespace flextip::diagnosis
