#include "testdata/broken/changes.h"

namespace flextip::broken {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}
double Either(Rng& rng, double x) { return Uniform(rng, 0.0, 1.0) < 0.5 ? x : -x; }
Vector3d Normal(Rng& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return {x, y, z};
}

void ShiftAll(Recording& r, double seconds) {
  if (r.wrist0) ShiftTimes(r.wrist0->samples, seconds);
  if (r.command0) ShiftTimes(r.command0->p_RW, seconds);
  if (r.em0) ShiftTimes(r.em0->samples, seconds);
  if (r.em1) ShiftTimes(r.em1->samples, seconds);
  if (r.strain0) ShiftTimes(r.strain0->moments_Nm, seconds);
  if (r.load0) ShiftTimes(r.load0->f_tip_N, seconds);
  if (r.vision0) ShiftTimes(r.vision0->tips, seconds);
  if (r.cam0) ShiftTimes(r.cam0->filenames, seconds);
}

double DurationOf(const Recording& r) {
  return 1e-9 * static_cast<double>(r.wrist0->samples.back().t_ns - r.wrist0->samples.front().t_ns);
}

void EachEm(Recording& r, const ChangePose& change) {
  for (auto& s : r.em0->samples) change(s.value.p_RS, s.value.q_RS);
}
void EachWrist(Recording& r, const ChangePose& change) {
  for (auto& s : r.wrist0->samples) change(s.value.p_RW, *s.value.q_RW);
}
void EachTip(Recording& r, const std::function<void(Vector3d&, Vector3d&)>& change) {
  for (auto& s : r.vision0->tips) change(s.value.p_RE, *s.value.d_RE);
}
void EachMoment(Recording& r, const std::function<void(Eigen::Vector4d&)>& change) {
  for (auto& s : r.strain0->moments_Nm) change(s.value);
}
void EachLoad(Recording& r, double factor) {
  for (auto& s : r.load0->f_tip_N) s.value *= factor;
}

Quaterniond InOrderXyzw(const Quaterniond& q) { return Quaterniond(q.x(), q.y(), q.z(), q.w()); }

void MirrorY(Vector3d& p, Quaterniond& q) {
  p.y() = -p.y();
  Matrix3d mirror = Matrix3d::Identity();
  mirror(1, 1) = -1.0;
  q = Quaterniond(Matrix3d(mirror * q.toRotationMatrix() * mirror));
}

void Invert(Vector3d& p, Quaterniond& q) {
  const Pose inverse = Pose::FromQuaternion(q, p).Inverse();
  p = inverse.p;
  q = inverse.Quaternion();
}

void AxisZ(Quaterniond& q) {
  Matrix3d turn;  // its z column is x
  turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  q = q * Quaterniond(turn);
}

ChangePose InCamera(const Recording& r) {
  return [T_CR = r.cam0->calibration.T_RC.Inverse()](Vector3d& p, Quaterniond& q) {
    const Pose in_C = T_CR * Pose::FromQuaternion(q, p);
    p = in_C.p;
    q = in_C.Quaternion();
  };
}

}  // namespace flextip::broken
