#include "diagnosis/model/extended_instrument.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "diagnosis/effects/discovered/discovered_term.h"
#include "diagnosis/model/extended_effect.h"
#include "diagnosis/model/geometry.h"
#include "diagnosis/replay/sensor_prediction.h"
#include "estimation/saved_state.h"

namespace flextip::diagnosis {

using namespace sample_input;

namespace {

/// Backwards through sensor_prediction's ThroughLens, by iteration: what a lens leaves over is
/// small.
Eigen::Vector3d BeforeLens(const Eigen::Vector3d& axis, const SampleInputs& u,
                           const Eigen::Vector3d& seen) {
  constexpr int kIterations = 5;
  Eigen::Vector3d p = seen;
  for (int i = 0; i < kIterations; ++i) {
    const double depth = std::max(axis.dot(p), 1e-3);
    const Eigen::Vector3d across = p - axis.dot(p) * axis;
    const double r2 = across.squaredNorm() / (depth * depth);
    const double sideways = u[kLensRadial] - u[kLensDepth];
    p = seen - r2 * (sideways * across - u[kLensDepth] * depth * axis);
  }
  return p;
}

}  // namespace

struct ExtendedInstrument::Acting {
  std::unique_ptr<Effect> effect;
  Eigen::VectorXd theta;
  EffectMemory memory{};
  std::vector<std::vector<double>> reported = {};
  Eigen::MatrixXd spread = {};  ///< of theta, each column one standard deviation; empty: exact
};

ExtendedInstrument::~ExtendedInstrument() = default;

ExtendedInstrument::ExtendedInstrument(const ExtendedModel& model, const Recording& base,
                                       const EffectMakers& own)
    : start_ns_(model.start_ns), solved_(std::make_unique<SolvedSample>()) {
  set_.instrument = base.instrument;
  set_.p_RP = base.p_RP;
  set_.gravity_m_s2 = base.gravity_m_s2;
  set_.centre = model.centre_m;
  set_.has_camera = base.cam0 && base.cam0->has_T_RC;
  if (set_.has_camera) set_.T_RC = base.cam0->calibration.T_RC;
  set_.samples.resize(1);
  for (const Term& term : model.discovered) {
    auto effect = std::make_unique<DiscoveredTerm>(term, "discovered");
    needs_port_place_ |= effect->NeedsPortPlace();
    Acting acting;
    acting.theta = effect->Theta();
    acting.effect = std::move(effect);
    acting_.push_back(std::move(acting));
  }
  for (const auto* list : {&model.effects, &model.within_tolerance}) {
    for (const EffectFit& fit : *list) {
      Acting acting;
      acting.effect = MakeEffectOfModel(fit.effect, own);
      if (!acting.effect) throw InputError("model: effect '" + fit.effect + "' is unknown");
      acting.effect->Parameters(set_);  // tells it what is nominal
      std::vector<std::vector<double>> values;
      for (const ReportedParameter& parameter : fit.parameters) values.push_back(parameter.value);
      acting.theta = acting.effect->FromReported(values);
      acting.reported = values;
      needs_port_place_ |= acting.effect->NeedsPortPlace();
      shaft_.wrist_play_m += acting.effect->WristPlay(acting.theta);
      acting_.push_back(std::move(acting));
    }
  }
  columns_.reserve(64);
  FactorTolerance(model);
}

/// theta's spread from the covariance of the reported numbers, as columns of its square root.
void ExtendedInstrument::FactorTolerance(const ExtendedModel& model) {
  const Eigen::MatrixXd& C = model.sensor_tolerance.covariance;
  spread_.setZero(Eigen::NoChange, C.cols());
  if (C.size() == 0) return;
  const SymmetricEigen axes(C);
  const Eigen::MatrixXd root = axes.vectors * axes.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  Eigen::Index row = 0;
  for (const std::string& name : model.sensor_tolerance.effects) {
    const auto acting = std::find_if(acting_.begin(), acting_.end(),
                                     [&](const Acting& a) { return a.effect->Name() == name; });
    FLEXTIP_CHECK(acting != acting_.end(), "a tolerance of an effect that the model has");
    acting->spread.setZero(acting->theta.size(), C.cols());
    for (std::vector<double>& numbers : acting->reported) {
      for (double& number : numbers) {
        const double at = number, step = 1e-3 * std::sqrt(C(row, row));
        if (step > 0.0) {
          number = at + step;
          const Eigen::VectorXd moved = acting->effect->FromReported(acting->reported);
          acting->spread += (moved - acting->theta) / step * root.row(row);
          number = at;
        }
        ++row;
      }
    }
  }
}

void ExtendedInstrument::SetSample(TimeNs t_ns, const Measurements& z,
                                   const Eigen::Vector3d& f_tip_N) {
  DiagnosisSample& now = set_.samples[0];
  now.t_s = 1e-9 * static_cast<double>(t_ns - start_ns_);
  now.p_RW = z.p_RW;
  now.f_tip_N = now.f_around_N = z.load ? z.load->f_tip_N : f_tip_N;
  // As in sample_set: without a measured orientation, R's axes turned without twist to the port.
  const Eigen::Vector3d to_port = (set_.p_RP - z.p_RW).normalized();
  now.y_wrist = z.R_RW ? Eigen::Vector3d(z.R_RW->col(1))
                       : Eigen::Vector3d(RotationWithoutTwist(Eigen::Vector3d::UnitX(), to_port) *
                                         Eigen::Vector3d::UnitY());
}

void ExtendedInstrument::Apply(Acting& acting, double s_port_free_m, double ds_port_dfriction_m) {
  const Instant now{set_,
                    0,
                    set_.samples[0].t_s,
                    s_port_free_m,
                    ds_port_dfriction_m,
                    has_shape_ ? solved_.get() : nullptr};
  columns_.clear();
  InputChange change(acting.theta.data(), 0, inputs_, columns_);
  const Eigen::Vector3d before_m = inputs_.segment<3>(kWrist);
  acting.effect->Apply(acting.theta.data(), now, acting.memory, change);
  if (acting.effect->WristPlay(acting.theta) == 0.0)
    shaft_.wrist_misread_m += inputs_.segment<3>(kWrist) - before_m;
  if (acting.spread.size() == 0) return;
  for (const InputChange::Column& column : columns_)
    spread_.row(column.input) += column.value * acting.spread.row(column.parameter);
}

/// Where the port and the tip are with the friction of the last instant: what the next one's
/// friction and the tags' offset are reckoned from. Where there is no equilibrium, the last holds.
void ExtendedInstrument::SolveShaft() {
  const SolvedSample solved = SolveSample(set_, 0, inputs_, set_.samples[0].f_tip_N, solver_);
  if (!solved.ok) return;
  *solved_ = solved;
  has_shape_ = true;
  ds_port_dfriction_m_ = solved.ds_port_dfriction_m;
  s_port_free_m_ = solved.s_port_m - ds_port_dfriction_m_ * friction_;
  R_RE_.col(0) = solved.at.segment<3>(place::kTipTangent);
  R_RE_.col(1) = solved.at.segment<3>(place::kTipY);
  R_RE_.col(2) = R_RE_.col(0).cross(R_RE_.col(1));
}

void ExtendedInstrument::Advance(TimeNs t_ns, const Measurements& measured,
                                 const Eigen::Vector3d& f_tip_N) {
  if (!measured.p_RW.allFinite()) return;
  SetSample(t_ns, measured, f_tip_N);
  inputs_.setZero();
  shaft_.wrist_misread_m.setZero();
  spread_.setZero();
  for (Acting& acting : acting_)
    if (!acting.effect->NeedsPortPlace()) Apply(acting, 0.0, 0.0);
  if (needs_port_place_ || !inputs_.segment<3>(kTagOffset).isZero(0.0)) {
    inputs_[kPortFriction] = friction_;
    SolveShaft();
    inputs_[kPortFriction] = 0.0;
  }
  for (Acting& acting : acting_)
    if (acting.effect->NeedsPortPlace()) Apply(acting, s_port_free_m_, ds_port_dfriction_m_);
  friction_ = inputs_[kPortFriction];
  FillShaft();
}

void ExtendedInstrument::FillShaft() {
  const SampleInputs& u = inputs_;
  shaft_.stiffness_scale = std::exp(u[kStiffness]);
  shaft_.length_delta_m = u[kLength];
  shaft_.weight_N_m = u.segment<3>(kWeight);
  shaft_.wrist_shift_m = u.segment<3>(kWrist);
  shaft_.port_shift_m = u.segment<3>(kPort);
  shaft_.tip_compliance_m_N = u[kTipCompliance];
  shaft_.effects = EffectsOf(u, set_.samples[0].y_wrist);
}

void ExtendedInstrument::CorrectEm(const SampleInputs& u, EmMeasurement& em) const {
  const Eigen::Matrix3d back = ExpRotation(-u.segment<3>(kEmTurn));
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> G(u.data() + kEmGradient);
  // measured = centre + shift + R ((I + G) (p - centre) + offset)
  const Eigen::Vector3d bent =
      back * (em.T_RS.p - set_.centre - u.segment<3>(kEmShift)) - u.segment<3>(kEmOffset);
  const Eigen::Matrix3d unbend = (Eigen::Matrix3d::Identity() + G).inverse();
  em.T_RS.p = set_.centre + unbend * bent;
  em.T_RS.R = back * ExpRotation(-u.segment<3>(kEmReadTurn)) * em.T_RS.R;
  em.position_noise_m *= unbend.norm() / std::sqrt(3.0);  // the RMS over all directions
}

/// Backwards through sensor_prediction's SeenTip and TrueTip; the yielding tip is the shaft's
/// affair.
void ExtendedInstrument::CorrectTip(const SampleInputs& u, Measurements& z) const {
  TipObservation& tip = *z.tip;
  const Eigen::Vector3d p_RC = set_.has_camera ? set_.T_RC.p : set_.centre;
  const Eigen::Matrix3d vision_back = ExpRotation(-u.segment<3>(kVisionTurn));
  const Eigen::Matrix3d camera = ExpRotation(u.segment<3>(kCameraTurn));
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();  // undoes the focal length's shrinking
  if (set_.has_camera) {
    const Eigen::Vector3d axis = set_.T_RC.R.col(2);
    stretch += (std::exp(u[kLogFocal]) - 1.0) * axis * axis.transpose();
  }
  const Eigen::Matrix3d A = camera * stretch * vision_back;
  const Eigen::Vector3d seen =
      vision_back * (tip.p_RE - set_.centre - u.segment<3>(kVisionShift)) + set_.centre;
  Eigen::Vector3d from_camera = stretch * (seen - p_RC);
  if (set_.has_camera) from_camera = BeforeLens(set_.T_RC.R.col(2), u, from_camera);
  tip.p_RE = p_RC + u.segment<3>(kCameraShift) + camera * from_camera;
  tip.p_RE -= R_RE_ * u.segment<3>(kTagOffset);
  tip.covariance_m2 = A * tip.covariance_m2 * A.transpose();
  if (!tip.d_RE) return;
  Eigen::Matrix3d focal = Eigen::Matrix3d::Identity();
  if (set_.has_camera) {  // a pose keeps its attitude to the line of sight
    const Eigen::Vector3d p_C = set_.T_RC.R.transpose() * (tip.p_RE - set_.T_RC.p);
    const double depth_m = std::max(p_C.z(), 1e-3);
    const Eigen::Vector3d axis =
        set_.T_RC.R * Eigen::Vector3d(-p_C.y() / depth_m, p_C.x() / depth_m, 0.0);
    const double turn = u[kFocalTurn] + u[kLensTurn] * axis.squaredNorm();
    focal = ExpRotation(-turn * axis);
  }
  tip.d_RE = camera * focal * vision_back * ExpRotation(-u.segment<3>(kTipReadTurn)) * *tip.d_RE;
}

Measurements ExtendedInstrument::CorrectBy(const SampleInputs& u,
                                           const Measurements& measured) const {
  Measurements z = measured;
  if (z.R_RW) z.R_RW = ExpRotation(-u.segment<3>(kWristReadTurn)) * *z.R_RW;
  if (z.em) CorrectEm(u, *z.em);
  if (z.port_direction) z.port_direction = ExpRotation(-u.segment<3>(kEmTurn)) * *z.port_direction;
  if (z.tip && z.tip->status != TipStatus::kLost) CorrectTip(u, z);
  if (z.strain) {
    const Eigen::Matrix4d back = StrainBridge(u).inverse();
    z.strain->moments_Nm = back * (z.strain->moments_Nm - u.segment<4>(kStrainOffset));
    z.strain->moment_noise_Nm *= back.norm() / 2.0;  // the RMS over the gages
  }
  if (z.load) z.load->f_tip_N += u.segment<3>(kForce);
  return z;
}

namespace {

/// Adds the difference of the same readings, corrected in two ways, to the noise of `z`, less the
/// way that sensors placed from the tip go with a shaft longer by `longer_m`. Noises are the same
/// for all axes: a difference is shared by them.
void AddToNoise(const Measurements& moved, const Measurements& corrected, double longer_m,
                Measurements& z) {
  const auto add = [](double& noise, double difference, int axes) {
    noise = std::hypot(noise, difference / std::sqrt(axes));
  };
  if (z.em) {
    const Pose &a = moved.em->T_RS, &b = corrected.em->T_RS;
    add(z.em->position_noise_m, (a.p - b.p - longer_m * b.R.col(0)).norm(), 3);
    add(z.em->orientation_noise_rad, LogRotation(a.R * b.R.transpose()).norm(), 3);
  }
  if (z.port_direction)
    add(z.port_direction_noise_rad, (*moved.port_direction - *corrected.port_direction).norm(), 2);
  if (z.tip && z.tip->status != TipStatus::kLost) {
    Eigen::Vector3d shift = moved.tip->p_RE - corrected.tip->p_RE;
    if (corrected.tip->d_RE) shift -= longer_m * *corrected.tip->d_RE;
    z.tip->covariance_m2 += shift * shift.transpose();
    if (z.tip->d_RE)
      add(z.tip_direction_noise_rad, (*moved.tip->d_RE - *corrected.tip->d_RE).norm(), 2);
  }
  if (z.strain)
    add(z.strain->moment_noise_Nm, (moved.strain->moments_Nm - corrected.strain->moments_Nm).norm(),
        4);
}

}  // namespace

Measurements ExtendedInstrument::Correct(const Measurements& measured) const {
  const Measurements corrected = CorrectBy(inputs_, measured);
  Measurements z = corrected;
  for (Eigen::Index k = 0; k < spread_.cols(); ++k)
    AddToNoise(CorrectBy(inputs_ + spread_.col(k), measured), corrected, spread_(kLength, k), z);
  return z;
}

void ExtendedInstrument::VisitState(StateText& state) {
  for (Acting& acting : acting_) state(acting.memory);
  state(inputs_);
  for (double& value : spread_.reshaped()) state(value);
  state(shaft_);
  state(friction_);
  state(solver_);
  state(s_port_free_m_);
  state(ds_port_dfriction_m_);
  state(R_RE_);
  state(has_shape_);
  state(solved_->at);
  state(solved_->lateral_force_N);
}

double ExtendedInstrument::LengthSd() const {
  return spread_.cols() == 0 ? 0.0 : spread_.row(kLength).norm();
}

}  // namespace flextip::diagnosis
