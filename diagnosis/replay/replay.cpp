#include "diagnosis/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/linear_algebra.h"
#include "diagnosis/replay/sample_loops.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kForceNeighbours = 4;  // on either side, that say what a force should be
constexpr std::size_t kSharedNoise = 8;      // samples over which smoothed loads share their noise
constexpr int kMostPasses = 5;
constexpr double kSameFriction = 0.01;  // axial over lateral force
constexpr std::size_t kSlideReach = 8;  // samples on either side that say how the shaft slides

}  // namespace

Replay::Replay(const SampleSet& samples, const ParameterLayout& layout)
    : samples_(samples),
      layout_(layout),
      retiming_(samples),
      force_unit_N_(samples.instrument.bending_stiffness_Nm2 / samples.instrument.length_m /
                    samples.instrument.length_m),
      theta_(Eigen::VectorXd::Zero(layout.Size())),
      replayed_(samples.samples.size()),
      along_prior_(1.0) {
  noise_scale_.fill(1.0);
  if (!samples.has_load) return;
  for (std::size_t k = 0; k < replayed_.size(); ++k)
    replayed_[k].f_tip_N = samples.samples[k].f_tip_N;
}

bool Replay::Evaluate(const Eigen::VectorXd& theta) {
  return EvaluateBy(theta, [this] { samples_.has_load ? SolveRods() : FitForces(); });
}

bool Replay::EvaluateWithForces(const Eigen::VectorXd& theta) {
  return EvaluateBy(theta, [this] { SolveRods(); });
}

/// Friction follows from how the shaft slides, and that from the shapes: again until it stays.
bool Replay::EvaluateBy(const Eigen::VectorXd& theta, const std::function<void()>& solve) {
  theta_ = theta;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const double change = ApplyEffects(theta);
    if (pass > 0 && change < kSameFriction) break;
    if (pass == 0)
      for (ReplayedSample& sample : replayed_)
        sample.stale = !samples_.has_load || !IsSolved(sample);
    Retime();
    solve();
  }
  return Finish();
}

/// Whether the sample's rod is that of its inputs and force: where only frequencies moved, it is.
bool Replay::IsSolved(const ReplayedSample& sample) {
  return sample.ok && sample.solved_inputs == sample.inputs &&
         sample.solved_f_tip_N == sample.f_tip_N;
}

bool Replay::Finish() {
  failed_ = int(std::count_if(replayed_.begin(), replayed_.end(),
                              [](const ReplayedSample& s) { return !s.ok; }));
  if (failed_ * 10 > int(replayed_.size())) return false;
  CompareSamples();
  return true;
}

/// Where on the shaft the port would be without friction, as the last replay has it.
double Replay::FreePortPlace(std::size_t k) const {
  const ReplayedSample& sample = replayed_[k];
  return sample.solved.s_port_m -
         sample.solved.ds_port_dfriction_m * sample.inputs[sample_input::kPortFriction];
}

/// The same by the least-squares parabola through the samples around: what makes the shaft stick or
/// slip must not be the noise of a force found from one sample.
double Replay::SmoothPortPlace(std::size_t k) const {
  const double own_m = FreePortPlace(k);
  if (!samples_.resolved_in_time || replayed_.size() <= 2 * kSlideReach) return own_m;
  const std::size_t first =
      std::clamp(k, kSlideReach, replayed_.size() - 1 - kSlideReach) - kSlideReach;
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  for (std::size_t a = first; a <= first + 2 * kSlideReach; ++a) {
    if (!replayed_[a].ok) return own_m;
    const double u = (samples_.samples[a].t_s - samples_.samples[k].t_s) / samples_.period_s;
    const Eigen::Vector3d basis(1.0, u, u * u);
    N += basis * basis.transpose();
    rhs += basis * FreePortPlace(a);
  }
  return Llt(N).Solve(rhs)[0];
}

/// Returns the largest change of the port's friction since the last replay.
double Replay::ApplyEffects(const Eigen::VectorXd& theta) {
  double change = 0.0;
  std::vector<EffectMemory> memory(layout_.Blocks().size());
  for (auto& m : memory) m.fill(0.0);
  std::vector<double> s_port_free_m(replayed_.size(), 0.0);
  for (std::size_t k = 0; k < replayed_.size(); ++k)
    if (replayed_[k].ok) s_port_free_m[k] = SmoothPortPlace(k);
  for (std::size_t k = 0; k < replayed_.size(); ++k) {
    ReplayedSample& sample = replayed_[k];
    Instant now{samples_, k, samples_.samples[k].t_s, s_port_free_m[k], 0.0};
    if (sample.ok) {
      now.ds_port_dfriction_m = sample.solved.ds_port_dfriction_m;
      now.solved = &sample.solved;
    }
    const double friction = sample.inputs[sample_input::kPortFriction];
    sample.inputs.setZero();
    sample.columns.clear();
    for (std::size_t b = 0; b < layout_.Blocks().size(); ++b) {
      const auto& block = layout_.Blocks()[b];
      InputChange input(theta.data() + block.first, block.first, sample.inputs, sample.columns);
      block.effect->Apply(theta.data() + block.first, now, memory[b], input);
    }
    if (samples_.has_load)  // what the load cell misreads
      sample.f_tip_N = samples_.samples[k].f_tip_N + sample.inputs.segment<3>(sample_input::kForce);
    const double by = std::abs(sample.inputs[sample_input::kPortFriction] - friction);
    sample.stale = by > 0.2 * kSameFriction;
    change = std::max(change, by);
  }
  return change;
}

void Replay::SolveRods() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    EffectRodSolver solver;
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      if (!sample.stale) continue;
      sample.solved = SolveSample(samples_, k, sample.inputs, sample.f_tip_N, solver);
      sample.solved_inputs = sample.inputs;
      sample.solved_f_tip_N = sample.f_tip_N;
      sample.ok = sample.solved.ok;
    }
  });
}

void Replay::Retime() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      replayed_[k].measured = retiming_.At(k, replayed_[k].inputs[sample_input::kEmDelay],
                                           replayed_[k].inputs[sample_input::kCameraDelay]);
  });
}

/// Where the five samples begin that say how sample `k` moves: two on either side, at the ends
/// those nearest to it that are judged by all that their sensors said, the others' forces being
/// poor.
std::optional<std::size_t> Replay::FirstOfFive(std::size_t k) const {
  const auto n = std::ptrdiff_t(replayed_.size()), middle = std::ptrdiff_t(k);
  const auto is_good = [&](std::ptrdiff_t first) {
    for (std::ptrdiff_t a = first; a < first + 5; ++a) {
      if (a < 0 || a >= n || !replayed_[a].ok) return false;
      const DiagnosisSample& sample = samples_.samples[a];
      if (!samples_.has_load && sample.present != sample.spoken) return false;
    }
    return true;
  };
  for (const std::ptrdiff_t by : {0, 1, -1, 2, -2})
    if (is_good(middle - 2 + by)) return std::size_t(middle - 2 + by);
  return {};
}

/// Rate and bend by the least-squares parabola through them.
TimedGeometry Replay::WithRate(std::size_t k) const {
  TimedGeometry timed{replayed_[k].solved.at, Geometry::Zero(), Geometry::Zero()};
  if (!samples_.resolved_in_time) return timed;
  const auto first = FirstOfFive(k);
  if (!first) return timed;
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, place::kCount> rhs;
  rhs.setZero();
  for (std::size_t a = *first; a < *first + 5; ++a) {
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

void Replay::Use(const Settings& settings) {
  noise_scale_ = settings.noise_scale;
  along_prior_ = settings.along_prior;
  input_noise_ = settings.input_noise;
  left_out_ = settings.left_out;
}

void Replay::LeaveOut(const std::vector<std::size_t>& samples) {
  left_out_.assign(replayed_.size(), false);
  for (const std::size_t k : samples) left_out_[k] = true;
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
/// this very sample must not look like something explained. With a known load that by stiffness is
/// its own less the load's noise: shapes are those of force over stiffness.
GeometryByInputs Replay::ExpectedDerivatives(std::size_t k) const {
  GeometryByInputs by = replayed_[k].solved.by_inputs;
  for (const int input : {rod_input::kPortCompliance, rod_input::kWristCompliance})
    by.col(input) = Around(
        k, [&](std::size_t j) -> Geometry { return replayed_[j].solved.by_inputs.col(input); });
  const auto with_force = [&](std::size_t j) -> Geometry {
    const GeometryByInputs& own = replayed_[j].solved.by_inputs;
    return own.col(rod_input::kStiffness) +
           own.middleCols<3>(rod_input::kForce) * replayed_[j].f_tip_N;
  };
  if (!samples_.has_load) {
    by.col(rod_input::kStiffness) += Around(k, with_force) - with_force(k);
  } else if (const auto noise_N = LoadNoise(k); noise_N && !own_derivatives_) {
    // Moments are a stiffness times a function of force over stiffness: of theirs, M - f dM/df, a
    // force's noise takes nothing.
    const Eigen::Matrix<double, 4, 1> of_moments =
        by.col(rod_input::kStiffness).segment<4>(place::kMoments);
    by.col(rod_input::kStiffness) += by.middleCols<3>(rod_input::kForce) * *noise_N;
    by.col(rod_input::kStiffness).segment<4>(place::kMoments) = of_moments;
  }
  return by;
}

/// What a gage's gain acts on: the moments, without what comes of this very sample's noise of the
/// force. With a known load as in the derivative by stiffness: a gain, a load cell's scale and a
/// stiffness that look alike must look quite alike, or many recordings tell them apart by how
/// roughly they were told.
Eigen::Vector4d Replay::ExpectedMoments(std::size_t k) const {
  const auto own = [&](std::size_t j) -> Eigen::Vector4d {
    return replayed_[j].solved.at.segment<4>(place::kMoments);
  };
  if (!samples_.has_load) return Around(k, own);
  const auto noise_N = LoadNoise(k);
  if (!noise_N || own_derivatives_) return own(k);
  return own(k) -
         replayed_[k].solved.by_inputs.block<4, 3>(place::kMoments, rod_input::kForce) * *noise_N;
}

void Replay::CompareSamples() {
  ForChunks(replayed_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      ReplayedSample& sample = replayed_[k];
      if (!sample.ok) continue;
      const Eigen::Vector3d expected_N =
          Around(k, [&](std::size_t j) -> Eigen::Vector3d { return replayed_[j].f_tip_N; });
      const TimedGeometry timed = WithRate(k);
      sample.rate = timed.rate;
      sample.bend = timed.bend;
      sample.compared =
          Compare(samples_, sample.measured, sample.inputs, ForceOnTip(sample.f_tip_N, expected_N),
                  timed, ExpectedDerivatives(k));
      const Eigen::Vector4d bends = ExpectedMoments(k);
      for (int i = 0; i < 4; ++i) {
        if (!sample.measured.Has(row::kStrain + i)) continue;
        auto by = sample.compared.by_inputs.row(row::kStrain + i);
        by[sample_input::kStrainGain + i] = bends[i];
        for (int j = 0; j < 4; ++j)
          if (j != i) by[StrainCross(i, j)] = bends[j];
      }
    }
  });
}

}  // namespace flextip::diagnosis
