#include "diagnosis/replay/sensor_prediction.h"

#include <cmath>

#include "core/rotation.h"

namespace flextip::diagnosis {
namespace {

using namespace sample_input;
using Three = Eigen::Matrix<double, 3, sample_input::kCount>;

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
  void Turn(const SampleInputs& u, int input, double sign) {
    const Eigen::Vector3d w = sign * u.segment<3>(input);
    const Eigen::Matrix3d R = ExpRotation(w);
    v = R * v;
    d = R * d;
    d.middleCols<3>(input) -= sign * Skew(v) * LeftJacobian(w);
  }
  void Shift(const SampleInputs& u, int input, double sign) {
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

Predicted EmPosition(const SampleSet& samples, const SampleInputs& u, const TimedGeometry& sensed,
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

Predicted SeenByCamera(const TimedGeometry& sensed, const GeometryByInputs& by_inputs, int at) {
  Predicted seen(sensed, by_inputs, at);
  seen.Delay(sensed, at, kCameraDelay);
  return seen;
}

/// E as it truly is: yielding under its force, with the tags off their place.
Predicted TrueTip(const SampleInputs& u, const ForceOnTip& f_tip, const TimedGeometry& sensed,
                  const GeometryByInputs& by_inputs) {
  Predicted p = SeenByCamera(sensed, by_inputs, place::kTip);
  p.v += u[kTipCompliance] * f_tip.at_N;
  p.d.col(kTipCompliance) += f_tip.expected_N;
  p.d.middleCols<3>(kForce) += u[kTipCompliance] * Eigen::Matrix3d::Identity();
  const Predicted x = SeenByCamera(sensed, by_inputs, place::kTipTangent),
                  y = SeenByCamera(sensed, by_inputs, place::kTipY);
  Eigen::Matrix3d R_RE;
  R_RE << x.v, y.v, x.v.cross(y.v);
  const Eigen::Vector3d offset = u.segment<3>(kTagOffset);
  p.v += R_RE * offset;
  p.d += offset.x() * x.d + offset.y() * y.d + offset.z() * (Skew(x.v) * y.d - Skew(y.v) * x.d);
  p.d.middleCols<3>(kTagOffset) += R_RE;
  return p;
}

/// The line of sight is displaced by 1 + k1 r^2, and the tip seems nearer by the depth's k1 r^2: to
/// first order, about the camera.
void ThroughLens(const Pose& T_RC, const SampleInputs& u, Predicted& p) {
  const Eigen::Vector3d axis = T_RC.R.col(2);
  const double depth = axis.dot(p.v);
  const Eigen::Vector3d across = p.v - depth * axis;
  const Eigen::RowVector3d by_depth = axis.transpose();
  const double r2 = across.squaredNorm() / (depth * depth);
  // Of r2 by the place: across and depth are at a right angle.
  const Eigen::RowVector3d dr2 =
      2.0 / (depth * depth) * across.transpose() - 2.0 * r2 / depth * by_depth;
  const double sideways = u[kLensRadial] - u[kLensDepth], nearer = u[kLensDepth];
  const Eigen::Matrix3d by_p =
      Eigen::Matrix3d::Identity() +
      sideways * (r2 * (Eigen::Matrix3d::Identity() - axis * by_depth) + across * dr2) -
      nearer * axis * (r2 * by_depth + depth * dr2);
  const Eigen::Vector3d seen = p.v + r2 * (sideways * across - nearer * depth * axis);
  p.d = (by_p * p.d).eval();
  p.d.col(kLensRadial) += r2 * across;
  p.d.col(kLensDepth) -= r2 * p.v;
  p.v = seen;
}

/// What a camera that is not where it was registered, with another focal length, makes of it.
Predicted SeenTip(const SampleSet& samples, const SampleInputs& u, Predicted p) {
  const Eigen::Vector3d p_RC = samples.has_camera ? samples.T_RC.p : samples.centre;
  p.v -= p_RC;
  p.Shift(u, kCameraShift, -1.0);
  p.Turn(u, kCameraTurn, -1.0);
  if (samples.has_camera) ThroughLens(samples.T_RC, u, p);
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

/// A pose from tags keeps its attitude to the line of sight, which a changed focal length or lens
/// moves away from the axis (to first order).
void TurnBySight(const SampleSet& samples, const SampleInputs& u, const Predicted& p_RE,
                 Predicted& d) {
  const Eigen::Matrix3d& R_RC = samples.T_RC.R;
  const Eigen::Vector3d p_C = R_RC.transpose() * (p_RE.v - samples.T_RC.p);
  const double x = p_C.x() / p_C.z(), y = p_C.y() / p_C.z(), r2 = x * x + y * y;
  const Eigen::Vector3d axis = R_RC * Eigen::Vector3d(-y, x, 0.0), turned = axis.cross(d.v);
  Eigen::Matrix3d by_p_C;
  by_p_C << 0, -1, y, 1, 0, -x, 0, 0, 0;
  const Eigen::RowVector3d r2_by_p_C = 2.0 * Eigen::RowVector3d(x, y, -r2);
  const Three d_p_C = R_RC.transpose() * p_RE.d / p_C.z(), d_axis = R_RC * by_p_C * d_p_C;
  const double turn = u[kFocalTurn] + u[kLensTurn] * r2;
  d.d += (turn * (Skew(axis) * d.d - Skew(d.v) * d_axis)).eval();
  d.d += u[kLensTurn] * turned * (r2_by_p_C * d_p_C);
  d.d.col(kFocalTurn) += turned;
  d.d.col(kLensTurn) += r2 * turned;
  d.v += turn * turned;
}

}  // namespace

Eigen::Matrix4d StrainBridge(const SampleInputs& u) {
  Eigen::Matrix4d bridge = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) bridge(i, j) += u[i == j ? kStrainGain + i : StrainCross(i, j)];
  return bridge;
}

SampleResidual Compare(const SampleSet& samples, const DiagnosisSample& z, const SampleInputs& u,
                       const ForceOnTip& f_tip, const TimedGeometry& geometry,
                       const GeometryByInputs& by_inputs) {
  SampleResidual out;
  const TimedGeometry em = geometry.After(z.dt_em_s - u[kEmDelay]);
  const TimedGeometry tip = geometry.After(z.dt_tip_s - u[kCameraDelay]);
  const TimedGeometry gages = geometry.After(z.dt_strain_s), port = geometry.After(z.dt_port_s);
  if (z.Has(row::kWristDirection)) {
    Predicted d(geometry, by_inputs, place::kWristTangent);
    d.Turn(u, kWristReadTurn, 1.0);
    AddDirection(z.d_wrist, d, row::kWristDirection, out);
  }
  if (z.Has(row::kPortDirection))
    AddDirection(z.d_port, Predicted(port, by_inputs, place::kPortTangent), row::kPortDirection,
                 out);
  if (z.Has(row::kEmPosition))
    AddVector(z.p_RS, EmPosition(samples, u, em, by_inputs), row::kEmPosition, out);
  if (z.Has(row::kEmDirection)) {
    Predicted d(em, by_inputs, place::kEmTangent);
    d.Delay(em, place::kEmTangent, kEmDelay);
    d.Turn(u, kEmTurn, 1.0);
    d.Turn(u, kEmReadTurn, 1.0);
    AddDirection(z.d_em, d, row::kEmDirection, out);
  }
  const Eigen::Matrix4d bridge = StrainBridge(u);
  const Eigen::Vector4d bends = gages.at.segment<4>(place::kMoments);
  for (int i = 0; i < 4; ++i) {
    if (!z.Has(row::kStrain + i)) continue;
    const int r = row::kStrain + i;
    out.residual[r] = z.moments_Nm[i] - bridge.row(i).dot(bends) - u[kStrainOffset + i];
    out.by_inputs.row(r).head<rod_input::kCount>() =
        bridge.row(i) * by_inputs.middleRows<4>(place::kMoments);
    out.by_inputs(r, kStrainGain + i) = bends[i];
    out.by_inputs(r, kStrainOffset + i) = 1.0;
    for (int j = 0; j < 4; ++j)
      if (j != i) out.by_inputs(r, StrainCross(i, j)) = bends[j];
  }
  if (z.Has(row::kTipPosition))
    AddVector(z.p_RE, SeenTip(samples, u, TrueTip(u, f_tip, tip, by_inputs)), row::kTipPosition,
              out);
  if (z.Has(row::kTipDirection)) {
    Predicted d = SeenByCamera(tip, by_inputs, place::kTipTangent);
    d.Turn(u, kCameraTurn, -1.0);
    if (samples.has_camera) TurnBySight(samples, u, SeenByCamera(tip, by_inputs, place::kTip), d);
    d.Turn(u, kVisionTurn, 1.0);
    d.Turn(u, kTipReadTurn, 1.0);
    AddDirection(z.d_tip, d, row::kTipDirection, out);
  }
  return out;
}

}  // namespace flextip::diagnosis
