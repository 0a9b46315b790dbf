// Changes that the ways are made of: for the sources of this folder.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>

#include "testdata/broken/broken_recording.h"

namespace flextip::broken {

inline constexpr double kHour_s = 3600.0;

double Uniform(Rng& rng, double from, double to);
/// Returns `x` or `-x`.
double Either(Rng& rng, double x);
Eigen::Vector3d Normal(Rng& rng);

template <class T>
void ShiftTimes(Series<T>& series, double seconds) {
  for (auto& s : series) s.t_ns += static_cast<TimeNs>(std::llround(seconds * 1e9));
}
/// Counts the times from the stream's own start.
template <class T>
void FromZero(Series<T>& series) {
  const TimeNs begin = series.front().t_ns;
  for (auto& s : series) s.t_ns -= begin;
}
template <class T>
void DivideTimes(Series<T>& series, TimeNs by) {
  for (auto& s : series) s.t_ns /= by;
}
template <class T>
void Repeat(Series<T>& series, std::size_t times) {
  for (std::size_t i = 0; i < series.size(); ++i) series[i].value = series[i - i % times].value;
}
/// Keeps the value at the share `from` of the series to its end.
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

/// Shifts the times of all streams.
void ShiftAll(Recording& recording, double seconds);
/// Returns the wrist's duration (s).
double DurationOf(const Recording& recording);

using ChangePose = std::function<void(Eigen::Vector3d& p, Eigen::Quaterniond& q)>;
void EachEm(Recording& recording, const ChangePose& change);
void EachWrist(Recording& recording, const ChangePose& change);
void EachTip(Recording& recording,
             const std::function<void(Eigen::Vector3d& p, Eigen::Vector3d& d)>& change);
void EachMoment(Recording& recording, const std::function<void(Eigen::Vector4d&)>& change);
void EachLoad(Recording& recording, double factor);

/// Returns x, y, z, w read as w, x, y, z.
Eigen::Quaterniond InOrderXyzw(const Eigen::Quaterniond& q);
/// Turns y upside down, as a left-handed file has it.
void MirrorY(Eigen::Vector3d& p, Eigen::Quaterniond& q);
void Invert(Eigen::Vector3d& p, Eigen::Quaterniond& q);
/// Puts z along the shaft in place of x.
void AxisZ(Eigen::Quaterniond& q);
/// Returns the change from R to the camera's frame.
ChangePose InCamera(const Recording& recording);

}  // namespace flextip::broken
