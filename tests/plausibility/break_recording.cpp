#include "tests/plausibility/break_recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flextip {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Rng = BreakRng;
constexpr double kHour_s = 3600.0;

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}
double Either(Rng& rng, double x) { return Uniform(rng, 0.0, 1.0) < 0.5 ? x : -x; }
Vector3d Normal(Rng& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return {x, y, z};
}

template <class T>
void ShiftTimes(Series<T>& series, double seconds) {
  for (auto& s : series) s.t_ns += static_cast<TimeNs>(std::llround(seconds * 1e9));
}
template <class T>
void DivideTimes(Series<T>& series, TimeNs by) {
  for (auto& s : series) s.t_ns /= by;
}
template <class T>
void Repeat(Series<T>& series, std::size_t times) {
  for (std::size_t i = 0; i < series.size(); ++i) series[i].value = series[i - i % times].value;
}
template <class T>
void Freeze(Series<T>& series, double from) {
  const auto at = static_cast<std::size_t>(from * static_cast<double>(series.size()));
  for (std::size_t i = at; i < series.size(); ++i) series[i].value = series[at].value;
}
template <class T>
void CutOut(Series<T>& series, double from, double to) {
  const double n = static_cast<double>(series.size());
  series.erase(series.begin() + static_cast<std::ptrdiff_t>(from * n),
               series.begin() + static_cast<std::ptrdiff_t>(to * n));
}

using ChangePose = std::function<void(Vector3d&, Quaterniond&)>;
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

/// A left-handed file: y upside down in both frames.
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

/// z along the shaft in place of x.
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

std::vector<BrokenWay> EmWays() {
  const auto scaled = [](double factor) {
    return [factor](Recording& r, Rng&) {
      EachEm(r, [&](Vector3d& p, Quaterniond&) { p *= factor; });
    };
  };
  return {
      {"em0 in mm", "em0.unit", false, scaled(1e3)},
      {"em0 in cm", "em0.unit", false, scaled(1e2)},
      {"em0 in inch", "em0.unit", false, scaled(1.0 / 0.0254)},
      {"em0 quaternion xyzw", "em0.quaternion_order", false,
       [](Recording& r, Rng&) {
         EachEm(r, [](Vector3d&, Quaterniond& q) { q = InOrderXyzw(q); });
       }},
      {"em0 quaternion inverted", "em0.quaternion_inverse", false,
       [](Recording& r, Rng&) { EachEm(r, [](Vector3d&, Quaterniond& q) { q = q.conjugate(); }); }},
      {"em0 pose inverted", "em0.inverse", false, [](Recording& r, Rng&) { EachEm(r, Invert); }},
      {"em0 z along the shaft", "em0.axis", false,
       [](Recording& r, Rng&) { EachEm(r, [](Vector3d&, Quaterniond& q) { AxisZ(q); }); }},
      {"em0 y mirrored", "em0.mirrored", false, [](Recording& r, Rng&) { EachEm(r, MirrorY); }},
      {"em0 in the camera's frame", "em0.frame", false,
       [](Recording& r, Rng&) { EachEm(r, InCamera(r)); }},
      {"em0 columns x and y", "em0.columns", false,
       [](Recording& r, Rng&) {
         EachEm(r, [](Vector3d& p, Quaterniond&) { std::swap(p.x(), p.y()); });
       }},
      {"em0 clock by hours", "em0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.em0->samples, Either(rng, kHour_s * std::round(Uniform(rng, 1.0, 9.0))));
       }},
      {"em0 clock from 0", "em0.clock", false,
       [](Recording& r, Rng&) {
         ShiftTimes(r.em0->samples, -1e-9 * static_cast<double>(r.em0->samples.front().t_ns));
       }},
      {"em0 clock by seconds", "em0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.em0->samples, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"em0 times in us", "em0.time_unit", false,
       [](Recording& r, Rng&) { DivideTimes(r.em0->samples, 1000); }},
      {"em0 frozen", "em0.frozen", false,
       [](Recording& r, Rng& rng) { Freeze(r.em0->samples, Uniform(rng, 0.3, 0.7)); }},
      {"em0 repeated", "em0.repeated", false,
       [](Recording& r, Rng& rng) {
         Repeat(r.em0->samples, static_cast<std::size_t>(std::round(Uniform(rng, 2.0, 6.0))));
       }},
      {"em0 noise above", "em0.noise", false,
       [](Recording& r, Rng& rng) {
         const double sd = Uniform(rng, 5.0, 12.0) * r.em0->position_noise_m;
         EachEm(r, [&](Vector3d& p, Quaterniond&) { p += sd * Normal(rng); });
       }},
      {"em0 noise below", "em0.noise", false,
       [](Recording& r, Rng& rng) { r.em0->position_noise_m *= Uniform(rng, 5.0, 12.0); }},
      {"em0 rate", "em0.rate", false,
       [](Recording& r, Rng& rng) { r.em0->rate_hz *= Uniform(rng, 1.3, 2.5); }},
      {"em0 gap", "em0.gap", false,
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.em0->samples, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"em0 distance from the wrist", "em0.distance", false,
       [](Recording& r, Rng&) {
         r.em0->distance_from_tip_m = r.instrument.length_m - r.em0->distance_from_tip_m;
       }},
      {"em0 distance in mm", "em0.distance", false,
       [](Recording& r, Rng&) { r.em0->distance_from_tip_m *= 1e3; }},
      {"em0 and em1 swapped", "em0.swapped", false,
       [](Recording& r, Rng&) { std::swap(r.em0->samples, r.em1->samples); }},
      {"em1 quaternion xyzw", "em1.quaternion_order", false,
       [](Recording& r, Rng&) {
         for (auto& s : r.em1->samples) s.value.q_RS = InOrderXyzw(s.value.q_RS);
       }},
      {"em1 z along the shaft", "em1.axis", false,
       [](Recording& r, Rng&) {
         for (auto& s : r.em1->samples) AxisZ(s.value.q_RS);
       }},
  };
}

std::vector<BrokenWay> WristWays() {
  return {
      {"wrist0 in mm", "wrist0.unit", false,
       [](Recording& r, Rng&) { EachWrist(r, [](Vector3d& p, Quaterniond&) { p *= 1e3; }); }},
      {"wrist0 quaternion xyzw", "wrist0.quaternion_order", false,
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d&, Quaterniond& q) { q = InOrderXyzw(q); });
       }},
      {"wrist0 quaternion inverted", "wrist0.quaternion_inverse", false,
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d&, Quaterniond& q) { q = q.conjugate(); });
       }},
      {"wrist0 pose inverted", "wrist0.inverse", false,
       [](Recording& r, Rng&) { EachWrist(r, Invert); }},
      {"wrist0 z along the shaft", "wrist0.axis", false,
       [](Recording& r, Rng&) { EachWrist(r, [](Vector3d&, Quaterniond& q) { AxisZ(q); }); }},
      {"wrist0 y mirrored", "wrist0.mirrored", false,
       [](Recording& r, Rng&) { EachWrist(r, MirrorY); }},
      {"wrist0 columns x and y", "wrist0.columns", false,
       [](Recording& r, Rng&) {
         EachWrist(r, [](Vector3d& p, Quaterniond&) { std::swap(p.x(), p.y()); });
       }},
      {"wrist0 in the camera's frame", "wrist0.frame", false,
       [](Recording& r, Rng&) { EachWrist(r, InCamera(r)); }},
      {"wrist0 clock by hours", "wrist0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.wrist0->samples, Either(rng, kHour_s * std::round(Uniform(rng, 1.0, 9.0))));
       }},
      {"wrist0 clock by seconds", "wrist0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.wrist0->samples, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"wrist0 times in ms", "wrist0.time_unit", false,
       [](Recording& r, Rng&) { DivideTimes(r.wrist0->samples, 1000000); }},
      {"wrist0 frozen", "wrist0.frozen", false,
       [](Recording& r, Rng& rng) { Freeze(r.wrist0->samples, Uniform(rng, 0.3, 0.7)); }},
      {"wrist0 gap", "wrist0.gap", false,
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.wrist0->samples, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"wrist0 rate", "wrist0.rate", false,
       [](Recording& r, Rng& rng) { r.wrist0->rate_hz *= Uniform(rng, 1.3, 2.5); }},
      {"wrist0 noise above", "wrist0.noise", false,
       [](Recording& r, Rng& rng) {
         const double sd = Uniform(rng, 5.0, 12.0) * r.wrist0->position_noise_m;
         EachWrist(r, [&](Vector3d& p, Quaterniond&) { p += sd * Normal(rng); });
       }},
      {"command0 in mm", "command0.unit", false,
       [](Recording& r, Rng&) {
         for (auto& s : r.command0->p_RW) s.value *= 1e3;
       }},
      {"command0 y mirrored", "command0.mirrored", false,
       [](Recording& r, Rng&) {
         for (auto& s : r.command0->p_RW) s.value.y() = -s.value.y();
       }},
      {"command0 clock by seconds", "command0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.command0->p_RW, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
  };
}

std::vector<BrokenWay> VisionWays() {
  return {
      {"vision0 in mm", "vision0.unit", false,
       [](Recording& r, Rng&) { EachTip(r, [](Vector3d& p, Vector3d&) { p *= 1e3; }); }},
      {"vision0 in the camera's frame", "vision0.frame", false,
       [](Recording& r, Rng&) {
         const Pose T_CR = r.cam0->calibration.T_RC.Inverse();
         EachTip(r, [&](Vector3d& p, Vector3d& d) { p = T_CR * p, d = T_CR.R * d; });
       }},
      {"vision0 direction backward", "vision0.direction", false,
       [](Recording& r, Rng&) { EachTip(r, [](Vector3d&, Vector3d& d) { d = -d; }); }},
      {"vision0 clock by seconds", "vision0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.vision0->tips, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"vision0 clock from 0", "vision0.clock", false,
       [](Recording& r, Rng&) {
         ShiftTimes(r.vision0->tips, -1e-9 * static_cast<double>(r.vision0->tips.front().t_ns));
       }},
      {"vision0 y mirrored", "vision0.mirrored", false,
       [](Recording& r, Rng&) {
         EachTip(r, [](Vector3d& p, Vector3d& d) { p.y() = -p.y(), d.y() = -d.y(); });
       }},
      {"vision0 columns y and z", "vision0.columns", false,
       [](Recording& r, Rng&) {
         EachTip(r, [](Vector3d& p, Vector3d&) { std::swap(p.y(), p.z()); });
       }},
      {"vision0 covariance too small", "vision0.noise", false,
       [](Recording& r, Rng&) {
         for (auto& s : r.vision0->tips) s.value.covariance_m2 /= 36.0;
       }},
      {"vision0 frozen", "vision0.frozen", false,
       [](Recording& r, Rng& rng) { Freeze(r.vision0->tips, Uniform(rng, 0.3, 0.7)); }},
      {"vision0 repeated", "vision0.repeated", false,
       [](Recording& r, Rng&) { Repeat(r.vision0->tips, 3); }},
  };
}

std::vector<BrokenWay> SettingWays() {
  return {
      {"port in mm", "port.unit", false, [](Recording& r, Rng&) { r.p_RP *= 1e3; }},
      {"port elsewhere", "port.place", false,
       [](Recording& r, Rng& rng) {
         Vector3d off = Normal(rng);
         off.x() = 0.2 * off.x();
         r.p_RP += Uniform(rng, 0.05, 0.12) * off.normalized();
       }},
      {"length in mm", "instrument.length_unit", false,
       [](Recording& r, Rng&) { r.instrument.length_m *= 1e3; }},
      {"length too short", "instrument.length", false,
       [](Recording& r, Rng& rng) { r.instrument.length_m *= Uniform(rng, 0.86, 0.9); }},
      {"stiffness in N mm2", "instrument.stiffness", false,
       [](Recording& r, Rng&) { r.instrument.bending_stiffness_Nm2 *= 1e6; }},
      {"diameter in mm", "instrument.diameter_unit", false,
       [](Recording& r, Rng&) { r.instrument.outer_diameter_m *= 1e3; }},
      {"gravity in g", "gravity.unit", false,
       [](Recording& r, Rng&) { r.gravity_m_s2 /= r.gravity_m_s2.norm(); }},
      {"gravity far from 9.81", "gravity.size", false,
       [](Recording& r, Rng& rng) { r.gravity_m_s2 *= Uniform(rng, 0.3, 0.8); }},
      {"gravity upward", "gravity.sign", true,
       [](Recording& r, Rng&) { r.gravity_m_s2 = -r.gravity_m_s2; }},
  };
}

std::vector<BrokenWay> ForceWays() {
  return {
      {"strain0 in N mm", "strain0.unit", false,
       [](Recording& r, Rng&) { EachMoment(r, [](Eigen::Vector4d& m) { m *= 1e3; }); }},
      {"strain0 sign", "strain0.sign", false,
       [](Recording& r, Rng&) { EachMoment(r, [](Eigen::Vector4d& m) { m = -m; }); }},
      {"strain0 y and z swapped", "strain0.columns", false,
       [](Recording& r, Rng&) {
         EachMoment(r, [](Eigen::Vector4d& m) { std::swap(m[0], m[1]), std::swap(m[2], m[3]); });
       }},
      {"strain0 stations' columns swapped", "strain0.stations", false,
       [](Recording& r, Rng&) {
         EachMoment(r, [](Eigen::Vector4d& m) { std::swap(m[0], m[2]), std::swap(m[1], m[3]); });
       }},
      {"strain0 stations beyond the shaft", "strain0.stations", false,
       [](Recording& r, Rng& rng) {
         r.strain0->station_from_wrist_m[1] = Uniform(rng, 1.05, 2.0) * r.instrument.length_m;
       }},
      {"strain0 stations swapped", "strain0.stations", false,
       [](Recording& r, Rng&) {
         std::swap(r.strain0->station_from_wrist_m[0], r.strain0->station_from_wrist_m[1]);
       }},
      {"strain0 stations in mm", "strain0.stations", false,
       [](Recording& r, Rng&) {
         for (double& s : r.strain0->station_from_wrist_m) s *= 1e3;
       }},
      {"strain0 frozen", "strain0.frozen", false,
       [](Recording& r, Rng& rng) { Freeze(r.strain0->moments_Nm, Uniform(rng, 0.3, 0.7)); }},
      {"strain0 noise below", "strain0.noise", false,
       [](Recording& r, Rng& rng) { r.strain0->moment_noise_Nm *= Uniform(rng, 5.0, 12.0); }},
      {"strain0 clock by seconds", "strain0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.strain0->moments_Nm, Either(rng, Uniform(rng, 1.0, 3.0)));
       }},
      {"strain0 repeated", "strain0.repeated", false,
       [](Recording& r, Rng&) { Repeat(r.strain0->moments_Nm, 4); }},
      {"load0 clock by seconds", "load0.clock", false,
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.load0->f_tip_N, Either(rng, Uniform(rng, 1.0, 3.0)));
       }},
      {"load0 frozen", "load0.frozen", false,
       [](Recording& r, Rng& rng) { Freeze(r.load0->f_tip_N, Uniform(rng, 0.3, 0.7)); }},
      {"load0 gap", "load0.gap", false,
       [](Recording& r, Rng& rng) {
         const double from = Uniform(rng, 0.2, 0.6);
         CutOut(r.load0->f_tip_N, from, from + Uniform(rng, 0.08, 0.2));
       }},
      {"strain0 clock by hours", "strain0.clock", false,
       [](Recording& r, Rng&) { ShiftTimes(r.strain0->moments_Nm, kHour_s); }},
      {"load0 in grams", "load0.unit", false, [](Recording& r, Rng&) { EachLoad(r, 1e3 / 9.81); }},
      {"load0 in mN", "load0.unit", false, [](Recording& r, Rng&) { EachLoad(r, 1e3); }},
      {"load0 sign", "load0.sign", false, [](Recording& r, Rng&) { EachLoad(r, -1.0); }},
      {"load0 clock from 0", "load0.clock", false,
       [](Recording& r, Rng&) {
         ShiftTimes(r.load0->f_tip_N, -1e-9 * static_cast<double>(r.load0->f_tip_N.front().t_ns));
       }},
      {"load0 of hundreds of N", "load0.large", false,
       [](Recording& r, Rng&) {
         r.strain0.reset(), r.em0.reset(), r.em1.reset(), r.vision0.reset();
         EachLoad(r, 1e3);
       }},
  };
}

std::vector<BrokenWay> CameraWays() {
  const auto camera = [](Recording& r) -> CameraCalibration& { return r.cam0->calibration; };
  return {
      {"cam0 T_RC identity", "cam0.identity", false,
       [=](Recording& r, Rng&) { camera(r).T_RC = Pose(); }},
      {"cam0 T_RC inverted", "cam0.inverse", false,
       [=](Recording& r, Rng&) { camera(r).T_RC = camera(r).T_RC.Inverse(); }},
      {"cam0 T_RC in mm", "cam0.unit", false, [=](Recording& r, Rng&) { camera(r).T_RC.p *= 1e3; }},
      {"cam0 looks along -z", "cam0.axes", false,
       [=](Recording& r, Rng&) {
         Matrix3d turn = Matrix3d::Identity();
         turn(1, 1) = turn(2, 2) = -1.0;
         camera(r).T_RC.R = camera(r).T_RC.R * turn;
       }},
      {"cam0 focal length in mm", "cam0.focal_length", false,
       [=](Recording& r, Rng& rng) {
         camera(r).fu_px = camera(r).fv_px = Uniform(rng, 3.0, 30.0);
       }},
      {"cam0 principal point outside", "cam0.principal_point", false,
       [=](Recording& r, Rng&) {
         std::swap(camera(r).fu_px, camera(r).cu_px), camera(r).cu_px *= 2;
       }},
      {"cam0 of twice the resolution", "cam0.resolution", false,
       [=](Recording& r, Rng&) { camera(r).width_px /= 2, camera(r).height_px /= 2; }},
      {"cam0 of half the resolution", "cam0.resolution", false,
       [=](Recording& r, Rng&) { camera(r).width_px *= 2, camera(r).height_px *= 2; }},
      {"tags0 too large", "tags0.size", false,
       [](Recording& r, Rng&) {
         for (auto& tag : r.tags0->tags) tag.size_m *= 1.5;
       }},
      {"tags0 in mm", "tags0.unit", false,
       [](Recording& r, Rng&) {
         for (auto& tag : r.tags0->tags) tag.size_m *= 1e3;
       }},
  };
}

}  // namespace

const std::vector<BrokenWay>& BrokenWays() {
  static const std::vector<BrokenWay> all = [] {
    std::vector<BrokenWay> ways;
    for (auto& part :
         {EmWays(), WristWays(), VisionWays(), SettingWays(), ForceWays(), CameraWays()})
      ways.insert(ways.end(), part.begin(), part.end());
    return ways;
  }();
  return all;
}

Recording BreakRecording(const Recording& recording, const BrokenWay& way, BreakRng& rng) {
  Recording broken = recording;
  way.make(broken, rng);
  return broken;
}

void AddFurtherStreams(Recording& r, BreakRng& rng) {
  if (r.em0 && r.wrist0 && r.wrist0->samples.front().value.q_RW) {
    r.em1 = *r.em0;
    r.em1->comment = "em port";
    r.em1->distance_from_tip_m = 0.0;
    r.em1->samples.clear();
    const std::size_t n = std::min(r.em0->samples.size(), r.wrist0->samples.size());
    for (std::size_t i = 0; i < n; ++i) {
      const WristSample& wrist = r.wrist0->samples[i].value;
      const double part = std::min(1.0, (r.p_RP - wrist.p_RW).norm() / r.instrument.length_m);
      r.em1->samples.push_back({r.em0->samples[i].t_ns,
                                {r.p_RP + r.em1->position_noise_m * Normal(rng),
                                 wrist.q_RW->slerp(part, r.em0->samples[i].value.q_RS)}});
    }
  }
  if (r.wrist0) {
    r.command0.emplace();
    r.command0->comment = "commanded";
    r.command0->rate_hz = r.wrist0->rate_hz;
    for (std::size_t i = 0; i + 2 < r.wrist0->samples.size(); ++i)
      r.command0->p_RW.push_back({r.wrist0->samples[i].t_ns, r.wrist0->samples[i + 2].value.p_RW});
  }
  r.tags0.emplace();
  for (int id = 0; id < 6; ++id) {
    const double angle = id * std::numbers::pi / 3.0;
    CollarTag tag;
    tag.id = id;
    tag.size_m = 0.005;
    tag.T_EG.p = {-0.03, 0.005 * std::sin(angle), 0.005 * std::cos(angle)};
    tag.T_EG.R << 1, 0, 0, 0, std::cos(angle), -std::sin(angle), 0, std::sin(angle),
        std::cos(angle);
    r.tags0->tags.push_back(tag);
  }
}

}  // namespace flextip
