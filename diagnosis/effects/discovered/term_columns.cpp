#include "diagnosis/effects/discovered/term_columns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/model/geometry.h"

namespace flextip::diagnosis {
namespace {

constexpr double kSpeedTime_s = 0.06;  // a live speed is smoothed over this
constexpr double kUnitDistance_m = 0.1;
constexpr double kLeastDistance_m = 0.005;
constexpr double kFade = 0.1;  // of the range: within it a smooth term fades to nothing
// Numbers of the memory: whether it has begun, then what shapes keep; time and
// speeds; values of the last sample.
constexpr int kBegun = 0, kKept = 1, kLastTime = 5, kLastValue = 6, kSpeed = 7, kPast = 8;

const DiagnosisSample& SampleOf(const Instant& now) { return now.samples.samples[now.k]; }

double Depth(const SampleSet& set, const DiagnosisSample& z) {
  return set.instrument.length_m - (set.p_RP - z.p_RW).norm();
}

/// Sliding velocity and wrist speed by the samples around.
void CentralSpeeds(const Instant& now, TermState& state) {
  constexpr std::size_t kReach = 2;
  const auto& all = now.samples.samples;
  const std::size_t from = now.k < kReach ? 0 : now.k - kReach;
  const std::size_t to = std::min(all.size() - 1, now.k + kReach);
  const double dt_s = all[to].t_s - all[from].t_s;
  if (dt_s <= 0.0) return;
  state.scalar[2] = (Depth(now.samples, all[to]) - Depth(now.samples, all[from])) / dt_s;
  state.scalar[3] = (all[to].p_RW - all[from].p_RW).norm() / dt_s;
}

/// The same by the last instant: of the depth alone, the wrist's speed being nearly that of what it
/// moves along.
void LiveSpeeds(const Instant& now, TermState& state, EffectMemory& memory) {
  const double depth = state.scalar[1], dt_s = now.t_s - memory[kLastTime];
  if (memory[kBegun] != 0.0 && dt_s > 0.0) {
    const double part = 1.0 - std::exp(-dt_s / kSpeedTime_s);
    memory[kSpeed] += part * ((depth - memory[kLastValue]) / dt_s - memory[kSpeed]);
  }
  memory[kLastValue] = depth;
  state.scalar[2] = memory[kSpeed];
  state.scalar[3] = std::abs(memory[kSpeed]);
}

double Delay(TermTarget target, const DiagnosisSample& z) {
  switch (target) {
    case TermTarget::kEmPosition:
    case TermTarget::kEmOrientation:
    case TermTarget::kEmTime:
      return z.dt_em_s;
    case TermTarget::kVisionPosition:
    case TermTarget::kVisionDirection:
    case TermTarget::kVisionTime:
      return z.dt_tip_s;
    case TermTarget::kStrain:
      return z.dt_strain_s;
    default:
      return 0.0;
  }
}

void TakeShape(TermTarget target, const Instant& now, TermState& state) {
  const Geometry& at = now.solved->at;
  const bool em = target == TermTarget::kEmPosition || target == TermTarget::kEmOrientation;
  state.position = at.segment<3>(em ? place::kEm : place::kTip);
  state.orientation = at.segment<3>(em ? place::kEmTangent : place::kTipTangent);
  state.scalar[4] = now.solved->lateral_force_N;
  if (now.samples.has_camera) {
    const Eigen::Vector3d p_C = now.samples.T_RC.Inverse() * at.segment<3>(place::kTip);
    state.scalar[6] = p_C.norm();
    if (p_C.z() > kLeastDistance_m) state.image = p_C.head<2>() / p_C.z();
  }
  if (target == TermTarget::kEmPosition) state.own.head<3>() = at.segment<3>(place::kEm);
  if (target == TermTarget::kEmOrientation) state.own.head<3>() = at.segment<3>(place::kEmTangent);
  if (target == TermTarget::kStrain) state.own = at.segment<4>(place::kMoments);
  if (target == TermTarget::kVisionPosition) state.own.head<3>() = at.segment<3>(place::kTip);
  if (target == TermTarget::kVisionDirection)
    state.own.head<3>() = at.segment<3>(place::kTipTangent);
  if (target == TermTarget::kWristOrientation)
    state.own.head<3>() = at.segment<3>(place::kWristTangent);
}

/// Cubic B-splines on equal steps from 0 to 1, clamped outside.
double Spline(int i, double x) {
  constexpr double kStep = 1.0 / (kSplines - 3);
  const double u = std::clamp(x, 0.0, 1.0) / kStep - (i - 1);
  const double r = std::abs(u);
  if (r >= 2.0) return 0.0;
  return r < 1.0 ? 2.0 / 3.0 - r * r + 0.5 * r * r * r : std::pow(2.0 - r, 3) / 6.0;
}

/// The columns of a shape without memory, of one number.
void FillColumns(const Term& term, double v, Eigen::Index row, TermColumns& columns) {
  const std::vector<double>& at = term.at;
  switch (term.shape) {
    case TermShape::kLinear:
      columns(row, 0) = v - at[0];
      return;
    case TermShape::kQuadratic:
      columns(row, 0) = v - at[0];
      columns(row, 1) = (v - at[0]) * (v - at[0]);
      return;
    case TermShape::kPeriodic:
      columns(row, 0) = std::sin(2.0 * std::numbers::pi * at[0] * v);
      columns(row, 1) = std::cos(2.0 * std::numbers::pi * at[0] * v);
      return;
    case TermShape::kStep:
      columns(row, 0) = 0.5 + 0.5 * std::tanh(2.0 * (v - at[0]) / at[1]);
      return;
    case TermShape::kBeyond:
      columns(row, 0) = std::max(0.0, v - at[0]);
      return;
    case TermShape::kBelow:
      columns(row, 0) = std::max(0.0, at[0] - v);
      return;
    case TermShape::kBand:
      columns(row, 0) = v - std::clamp(v, -at[0], at[0]);
      return;
    case TermShape::kTanh:
      columns(row, 0) = std::tanh(v / at[0]);
      return;
    case TermShape::kExponential:
      columns(row, 0) = std::exp(-(v - at[1]) / at[0]);
      return;
    case TermShape::kAfter:
      columns(row, 0) = v < at[1] ? 0.0 : std::exp(-(v - at[1]) / at[0]);
      return;
    case TermShape::kSmooth: {
      const double x = (v - at[0]) / (at[1] - at[0]), outside = std::max({0.0, -x, x - 1.0});
      const double fade = std::max(0.0, 1.0 - outside / kFade);
      for (int i = 0; i < kSplines; ++i) columns(row, i) = fade * Spline(i, x);
      return;
    }
    default:
      return;
  }
}

/// Where the variable stands against its past, of input `row`.
double Remembered(const Term& term, double v, double dt_s, Eigen::Index row, EffectMemory& memory) {
  double& kept = memory[static_cast<std::size_t>(kKept + row)];
  double& past = memory[static_cast<std::size_t>(kPast + row)];
  if (memory[kBegun] == 0.0) kept = past = v;
  if (term.shape == TermShape::kSmoothPlay) {
    const double left = std::exp(-std::abs(v - past) / term.at[0]);
    kept = v - left * (past - kept) - std::copysign(term.at[0] * (1.0 - left), v - past);
    past = v;
  } else if (term.shape == TermShape::kRelaxing) {
    kept += (1.0 - std::exp(-dt_s / term.at[0])) * (v - kept);
  } else {
    kept = std::clamp(kept, v - term.at[0], v + term.at[0]);
  }
  return v - kept;
}

bool IsOfVector(TermShape shape) {
  return shape == TermShape::kLinear || shape == TermShape::kQuadratic ||
         shape == TermShape::kRadial;
}

/// Two or three numbers, without memory from the heap: loops come here every cycle.
using Components = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

/// The columns of a shape of all components of a vector.
void FillOfVector(const Term& term, const Components& v, TermColumns& columns) {
  const Eigen::Index n = v.size();
  if (term.shape == TermShape::kRadial) {
    columns.row(0) = v.squaredNorm() * v.transpose();
    return;
  }
  columns.row(0).head(n) = v.transpose();
  if (term.shape != TermShape::kQuadratic) return;
  for (Eigen::Index i = 0, at = n; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j) columns(0, at++) = v[i] * v[j];
}

Components VectorOf(TermVariable variable, const TermState& state) {
  if (variable == TermVariable::kImagePosition) return state.image;
  return variable == TermVariable::kOrientation ? state.orientation : state.position;
}

double ScalarOf(TermVariable variable, const TermState& state) {
  return state.scalar[static_cast<std::size_t>(variable)];
}

}  // namespace

TermState StateAt(TermTarget target, const Instant& now, EffectMemory& memory) {
  const DiagnosisSample& z = SampleOf(now);
  TermState state;
  state.t_s = now.t_s + Delay(target, z);
  state.scalar[0] = state.t_s;
  state.scalar[1] = Depth(now.samples, z);
  if (now.samples.samples.size() > 1) {
    CentralSpeeds(now, state);
  } else {
    LiveSpeeds(now, state, memory);
  }
  state.scalar[5] = now.samples.has_load ? z.f_around_N.norm() : z.f_tip_N.norm();
  if (now.solved != nullptr) TakeShape(target, now, state);
  if (target == TermTarget::kWristPosition) state.own.head<3>() = z.p_RW;
  if (target == TermTarget::kLoad) state.own.head<3>() = z.f_around_N;
  return state;
}

TermColumns ColumnsAt(const Term& term, const TermState& state, EffectMemory& memory,
                      bool one_row) {
  const bool by_input = term.IsByInput();
  const int rows = by_input || !one_row ? term.Inputs() : 1;
  TermColumns columns = TermColumns::Zero(rows, term.Columns());
  const double dt_s = memory[kBegun] == 0.0 ? 0.0 : state.t_s - memory[kLastTime];
  for (Eigen::Index row = 0; row < (by_input ? rows : 1); ++row) {
    double v = 0.0;
    if (by_input) {
      v = term.variable == TermVariable::kPosition ? state.position[std::min<Eigen::Index>(row, 2)]
                                                   : state.own[row];
    } else if (Dimension(term.variable) == 1) {
      v = ScalarOf(term.variable, state);
    }
    if (HasMemory(term.shape)) {
      columns(row, 0) = Remembered(term, v, std::max(0.0, dt_s), row, memory);
    } else if (term.shape == TermShape::kInversePower) {
      const Eigen::Vector3d place(term.at[0], term.at[1], term.at[2]);
      const double r = std::max(kLeastDistance_m, (state.position - place).norm());
      columns(row, 0) = std::pow(r / kUnitDistance_m, -term.at[3]);
    } else if (term.shape == TermShape::kPastPlane) {
      const Eigen::Vector3d normal(term.at[0], term.at[1], term.at[2]);
      columns(row, 0) = std::max(0.0, normal.normalized().dot(state.position) - term.at[3]);
    } else if (IsOfVector(term.shape) && Dimension(term.variable) > 1 && !by_input) {
      FillOfVector(term, VectorOf(term.variable, state), columns);
    } else {
      FillColumns(term, v, row, columns);
    }
  }
  if (!by_input)
    for (Eigen::Index row = 1; row < rows; ++row) columns.row(row) = columns.row(0);
  memory[kBegun] = 1.0;
  memory[kLastTime] = state.t_s;
  return columns;
}

}  // namespace flextip::diagnosis
