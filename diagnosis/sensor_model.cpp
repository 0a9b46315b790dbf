#include "diagnosis/sensor_model.h"

#include "core/rotation.h"

namespace flextip {
namespace {

using namespace model_input;
using Three = Eigen::Matrix<double, 3, model_input::kCount>;

/// A predicted vector and its derivatives.
struct Predicted {
  Eigen::Vector3d v;
  Three d = Three::Zero();

  Predicted(const TimedGeometry& geometry, const GeometryByInputs& by_inputs, int at)
      : v(geometry.at.segment<3>(at)) {
    d.leftCols<rod_input::kCount>() = by_inputs.middleRows<3>(at);
  }
  void Delay(const TimedGeometry& geometry, int at, int input) {
    d.col(input) -= geometry.rate.segment<3>(at);
  }
  /// Turned by Exp(`sign` w) about the origin, w standing in inputs from `input` on.
  void Turn(const ModelInputs& u, int input, double sign) {
    const Eigen::Matrix3d R = ExpRotation(sign * u.segment<3>(input));
    v = R * v;
    d = R * d;
    d.middleCols<3>(input) -= sign * Skew(v);
  }
  void Shift(const ModelInputs& u, int input, double sign) {
    v += sign * u.segment<3>(input);
    d.middleCols<3>(input) += sign * Eigen::Matrix3d::Identity();
  }
};

void AddVector(const Eigen::Vector3d& measured, const Predicted& predicted, int first,
               SampleResidual& out) {
  out.residual.segment<3>(first) = measured - predicted.v;
  out.by_inputs.middleRows<3>(first) = predicted.d;
}

void AddDirection(const Eigen::Vector3d& measured, const Predicted& predicted, int first,
                  SampleResidual& out) {
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(measured);
  out.residual.segment<2>(first) = -across.transpose() * predicted.v;
  out.by_inputs.middleRows<2>(first) = across.transpose() * predicted.d;
}

Predicted EmPosition(const SampleSet& samples, const ModelInputs& u, const TimedGeometry& sensed,
                     const GeometryByInputs& by_inputs) {
  Predicted p(sensed, by_inputs, place::kEm);
  p.Delay(sensed, place::kEm, kEmDelay);
  p.v -= samples.centre;
  const Eigen::Vector3d from_centre = p.v;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> G(u.data() + kEmGradient);
  p.v += G * from_centre;
  p.d += (G * p.d).eval();
  for (int i = 0; i < 3; ++i) p.d.block<1, 3>(i, kEmGradient + 3 * i) += from_centre.transpose();
  p.Shift(u, kEmOffset, 1.0);
  p.Turn(u, kEmTurn, 1.0);
  p.Shift(u, kEmShift, 1.0);
  p.v += samples.centre;
  return p;
}

/// E as it truly is: yielding under its force, with the tags off their place.
Predicted TrueTip(const ModelInputs& u, const Eigen::Vector3d& f_tip_N, const TimedGeometry& sensed,
                  const GeometryByInputs& by_inputs) {
  Predicted p(sensed, by_inputs, place::kTip);
  p.Delay(sensed, place::kTip, kCameraDelay);
  p.v += u[kTipCompliance] * f_tip_N;
  p.d.col(kTipCompliance) += f_tip_N;
  p.d.middleCols<3>(kForce) += u[kTipCompliance] * Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R_RE;
  R_RE.col(0) = sensed.at.segment<3>(place::kTipTangent);
  R_RE.col(1) = sensed.at.segment<3>(place::kTipY);
  R_RE.col(2) = R_RE.col(0).cross(R_RE.col(1));
  p.v += R_RE * u.segment<3>(kTagOffset);
  p.d.middleCols<3>(kTagOffset) += R_RE;
  return p;
}

/// What a camera that is not where it was registered, with another focal length, makes of it.
Predicted SeenTip(const SampleSet& samples, const ModelInputs& u, Predicted p) {
  const Eigen::Vector3d p_RC = samples.has_camera ? samples.T_RC.p : samples.centre;
  p.v -= p_RC;
  p.Shift(u, kCameraShift, -1.0);
  p.Turn(u, kCameraTurn, -1.0);
  if (samples.has_camera) {  // tags look larger by the focal scale, so they seem nearer
    const Eigen::Vector3d axis = samples.T_RC.R.col(2);
    const double shrink = std::exp(-u[kLogFocal]);
    const double depth = axis.dot(p.v);
    p.v += (shrink - 1.0) * depth * axis;
    p.d += (shrink - 1.0) * axis * (axis.transpose() * p.d).eval();
    p.d.col(kLogFocal) -= shrink * depth * axis;
  }
  p.v += p_RC - samples.centre;
  p.Turn(u, kVisionTurn, 1.0);
  p.Shift(u, kVisionShift, 1.0);
  p.v += samples.centre;
  return p;
}

/// A pose from tags keeps its attitude to the line of sight, which a changed focal length moves
/// away from the axis (to first order).
void TurnByFocal(const SampleSet& samples, const ModelInputs& u, const Eigen::Vector3d& p_RE,
                 Predicted& d) {
  const Eigen::Vector3d p_C = samples.T_RC.R.transpose() * (p_RE - samples.T_RC.p);
  const Eigen::Vector3d axis =
      samples.T_RC.R * Eigen::Vector3d(-p_C.y() / p_C.z(), p_C.x() / p_C.z(), 0.0);
  d.v += u[kFocalTurn] * axis.cross(d.v);
  d.d += (u[kFocalTurn] * Skew(axis) * d.d).eval();
  d.d.col(kFocalTurn) += axis.cross(d.v);
}

}  // namespace

SampleResidual Compare(const SampleSet& samples, const DiagnosisSample& z, const ModelInputs& u,
                       const Eigen::Vector3d& f_tip_N, const TimedGeometry& geometry,
                       const GeometryByInputs& by_inputs) {
  SampleResidual out;
  if (z.Has(row::kWristDirection))
    AddDirection(z.d_wrist, Predicted(geometry, by_inputs, place::kWristTangent),
                 row::kWristDirection, out);
  if (z.Has(row::kPortDirection))
    AddDirection(z.d_port, Predicted(geometry, by_inputs, place::kPortTangent), row::kPortDirection,
                 out);
  if (z.Has(row::kEmPosition))
    AddVector(z.p_RS, EmPosition(samples, u, geometry, by_inputs), row::kEmPosition, out);
  if (z.Has(row::kEmDirection)) {
    Predicted d(geometry, by_inputs, place::kEmTangent);
    d.Delay(geometry, place::kEmTangent, kEmDelay);
    d.Turn(u, kEmTurn, 1.0);
    AddDirection(z.d_em, d, row::kEmDirection, out);
  }
  for (int i = 0; i < 4; ++i) {
    if (!z.Has(row::kStrain + i)) continue;
    const double gain = 1.0 + u[kStrainGain + i], moment = geometry.at[place::kMoments + i];
    const int r = row::kStrain + i;
    out.residual[r] = z.moments_Nm[i] - gain * moment - u[kStrainOffset + i];
    out.by_inputs.row(r).head<rod_input::kCount>() = gain * by_inputs.row(place::kMoments + i);
    out.by_inputs(r, kStrainGain + i) = moment;
    out.by_inputs(r, kStrainOffset + i) = 1.0;
  }
  if (z.Has(row::kTipPosition))
    AddVector(z.p_RE, SeenTip(samples, u, TrueTip(u, f_tip_N, geometry, by_inputs)),
              row::kTipPosition, out);
  if (z.Has(row::kTipDirection)) {
    Predicted d(geometry, by_inputs, place::kTipTangent);
    d.Delay(geometry, place::kTipTangent, kCameraDelay);
    d.Turn(u, kCameraTurn, -1.0);
    if (samples.has_camera) TurnByFocal(samples, u, geometry.at.segment<3>(place::kTip), d);
    d.Turn(u, kVisionTurn, 1.0);
    AddDirection(z.d_tip, d, row::kTipDirection, out);
  }
  return out;
}

}  // namespace flextip
