#include "testdata/hidden/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/rotation.h"

namespace flextip::hidden {
namespace {

using Course = std::function<Eigen::Vector3d(double)>;
using Rng = std::mt19937_64;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kGoldenAngle = 2.399963229728653;
constexpr double kSlowest = 0.6, kFastest = 1.35;  // pace; own frequencies are 0.09 to 0.44 Hz

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

struct Sine {
  double amplitude, frequency_hz, phase;
};

/// Sines of one coordinate whose amplitudes add up to 1.
struct Sines {
  std::vector<Sine> parts;

  Sines(Rng& rng, int count, double from_hz, double to_hz) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      // One frequency in each part of the band: never two alike.
      const double low = from_hz + (to_hz - from_hz) * i / count;
      const double frequency = Uniform(rng, low, low + 0.8 * (to_hz - from_hz) / count);
      parts.push_back({Uniform(rng, 0.5, 1.0) / (1.0 + i), frequency, Uniform(rng, 0.0, kTurn)});
      sum += parts.back().amplitude;
    }
    for (Sine& part : parts) part.amplitude /= sum;
  }
  double At(double t) const {
    double x = 0.0;
    for (const Sine& part : parts) {
      x += part.amplitude * std::sin(kTurn * part.frequency_hz * t + part.phase);
    }
    return x;
  }
};

Course SinesCourse(Rng& rng, int count, double from_hz, double to_hz) {
  const Sines depth(rng, count, from_hz, to_hz), a(rng, count, from_hz, to_hz),
      b(rng, count, from_hz, to_hz);
  return [=](double t) { return Eigen::Vector3d(depth.At(t), a.At(t), b.At(t)); };
}

/// Circles of radius 1, or one that goes from `inner` to 1 and back.
Course CircleCourse(Rng& rng, double inner) {
  const double frequency = Uniform(rng, 0.14, 0.26), phase = Uniform(rng, 0.0, kTurn);
  const double way = Uniform(rng, 0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  const double swing = Uniform(rng, 0.055, 0.08);
  const Sines depth(rng, 2, 0.09, 0.3);
  return [=](double t) {
    const double radius = inner + (1.0 - inner) * 0.5 * (1.0 - std::cos(kTurn * swing * t));
    const double angle = way * kTurn * frequency * t + phase;
    return Eigen::Vector3d(depth.At(t), radius * std::cos(angle), radius * std::sin(angle));
  };
}

/// Places one after the other, joined by minimum-jerk moves x = 10 u^3 - 15 u^4 + 6 u^5.
class Waypoints {
 public:
  explicit Waypoints(const Eigen::Vector3d& start) : times_{-2.0}, places_{start} {}

  /// Moves to `place`, at least `shortest_s` long and longer for a longer way.
  void To(const Eigen::Vector3d& place, double shortest_s = 0.9) {
    times_.push_back(times_.back() +
                     std::max(shortest_s, 1.1 * (place - places_.back()).cwiseAbs().maxCoeff()));
    places_.push_back(place);
  }
  void Stay(double time_s) {
    times_.push_back(times_.back() + time_s);
    places_.push_back(places_.back());
  }
  bool EndsBefore(double t) const { return times_.back() < t; }
  const Eigen::Vector3d& Last() const { return places_.back(); }

  Eigen::Vector3d At(double t) const {
    const auto after = std::upper_bound(times_.begin(), times_.end(), t);
    if (after == times_.begin()) return places_.front();
    if (after == times_.end()) return places_.back();
    const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
    const double u = (t - times_[i]) / (times_[i + 1] - times_[i]);
    return places_[i] + u * u * u * (10.0 + u * (6.0 * u - 15.0)) * (places_[i + 1] - places_[i]);
  }

 private:
  std::vector<double> times_;
  std::vector<Eigen::Vector3d> places_;
};

Eigen::Vector3d InBox(Rng& rng) {
  return {Uniform(rng, -1, 1), Uniform(rng, -1, 1), Uniform(rng, -1, 1)};
}

Course RasterCourse(Rng& rng, double until_s) {
  const bool swap = Uniform(rng, 0.0, 1.0) < 0.5;
  const Sines depth(rng, 2, 0.09, 0.25);
  const int lines = 5;
  Waypoints path({0.0, -1.0, -1.0});
  double side = 1.0, row = 0.0, step = 1.0;
  while (path.EndsBefore(until_s)) {
    const double b = 2.0 * row / (lines - 1) - 1.0;
    path.To({0.0, -side, b}, 0.5);
    path.To({0.0, side, b});
    side = -side;
    if (row + step < 0 || row + step > lines - 1) step = -step;
    row += step;
  }
  return [=](double t) {
    const Eigen::Vector3d x = path.At(t);
    return Eigen::Vector3d(depth.At(t), swap ? x.z() : x.y(), swap ? x.y() : x.z());
  };
}

Course InOutCourse(Rng& rng, double until_s) {
  Waypoints path(InBox(rng));
  double end = 1.0;
  while (path.EndsBefore(until_s)) {
    const Eigen::Vector3d side = InBox(rng);
    path.To({end * Uniform(rng, 0.7, 1.0), side.y(), side.z()}, 1.4);
    path.Stay(Uniform(rng, 0.2, 0.8));
    end = -end;
  }
  return [=](double t) { return path.At(t); };
}

Course PressCourse(Rng& rng, double until_s) {
  Waypoints path(InBox(rng));
  while (path.EndsBefore(until_s)) {
    Eigen::Vector3d place = InBox(rng);
    place.x() = Uniform(rng, -1.0, -0.3);
    path.To(place);
    for (int push = 0; push < 2; ++push) {
      const Eigen::Vector3d above = path.Last();
      const double z = Uniform(rng, -0.3, 0.3), y = Uniform(rng, -0.3, 0.3);
      const Eigen::Vector3d aside(0.0, y, z);
      Eigen::Vector3d in = above + aside;
      in.x() += Uniform(rng, 0.7, 1.3);
      path.To(in.cwiseMax(-1.0).cwiseMin(1.0), 1.0);
      path.Stay(Uniform(rng, 0.3, 0.7));
      path.To(above, 1.0);
    }
  }
  return [=](double t) { return path.At(t); };
}

Course StarCourse(Rng& rng, double until_s) {
  double angle = Uniform(rng, 0.0, kTurn);
  Waypoints path(Eigen::Vector3d::Zero());
  while (path.EndsBefore(until_s)) {
    const double radius = Uniform(rng, 0.6, 1.0);
    path.To({Uniform(rng, -1.0, 1.0), radius * std::cos(angle), radius * std::sin(angle)});
    path.To({Uniform(rng, -0.6, 0.6), 0.0, 0.0});
    angle += kGoldenAngle;
  }
  return [=](double t) { return path.At(t); };
}

Course MakeCourse(MotionKind kind, Rng& rng, double until_s) {
  switch (kind) {
    case MotionKind::kSines:
      return SinesCourse(rng, 3, 0.09, 0.44);
    case MotionKind::kRaster:
      return RasterCourse(rng, until_s);
    case MotionKind::kInOut:
      return InOutCourse(rng, until_s);
    case MotionKind::kCircle:
      return CircleCourse(rng, Uniform(rng, 0.6, 1.0));
    case MotionKind::kSpiral:
      return CircleCourse(rng, 0.05);
    case MotionKind::kPress:
      return PressCourse(rng, until_s);
    case MotionKind::kWander:
      return SinesCourse(rng, 7, 0.09, 0.42);
    case MotionKind::kStar:
      return StarCourse(rng, until_s);
    case MotionKind::kShake:
      return SinesCourse(rng, 7, 0.15, 2.2);
  }
  return {};
}

}  // namespace

const char* Name(MotionKind kind) {
  constexpr const char* kNames[kMotionKinds] = {"sines", "raster", "in_out", "circle", "spiral",
                                                "press", "wander", "star",   "shake"};
  return kNames[static_cast<int>(kind)];
}

std::vector<MotionKind> Kinds(MotionFamily family) {
  using enum MotionKind;
  if (family == MotionFamily::kTuning) return {kSines, kRaster, kInOut, kCircle};
  if (family == MotionFamily::kHeldOut) return {kSpiral, kPress, kWander, kStar};
  return {kSines, kRaster, kInOut, kCircle, kSpiral, kPress, kWander, kStar};
}

WristCourse::WristCourse(const MotionSetup& setup, std::uint64_t seed, double duration_s)
    : setup_(setup), sideways_(NormalBasis(setup.axis)) {
  Rng rng(seed);
  course_ = MakeCourse(setup.kind, rng, kFastest * duration_s + 1.0);
  pace_ = std::clamp(setup.peak_speed_m_s / PeakSpeed(duration_s), kSlowest, kFastest);
  // Another stretch of the course is run now, and the speed is not quite linear in the size.
  for (int i = 0; i < 20 && PeakSpeed(duration_s) > setup.peak_speed_m_s; ++i) {
    size_ *= std::max(0.5, 0.999 * setup.peak_speed_m_s / PeakSpeed(duration_s));
  }
}

double WristCourse::PeakSpeed(double duration_s) const {
  constexpr double kStep_s = 0.02;
  double peak = 0.0;
  for (double t = 0.0; t < duration_s; t += kStep_s) {
    peak = std::max(peak, (At(t + kStep_s) - At(t)).norm() / kStep_s);
  }
  return peak;
}

Eigen::Vector3d WristCourse::Direction(double t_s) const {
  const Eigen::Vector3d x = size_ * course_(pace_ * t_s);
  const Eigen::Vector2d angles = setup_.angle_rad * x.tail<2>();
  return (setup_.axis + sideways_ * angles.array().tan().matrix()).normalized();
}

Eigen::Vector3d WristCourse::At(double t_s) const { return StraightPoint(t_s, 0.0); }

Eigen::Vector3d WristCourse::StraightPoint(double t_s, double s_m) const {
  const double x = size_ * course_(pace_ * t_s).x();
  const double depth =
      0.5 * (setup_.depth_from + setup_.depth_to) + 0.5 * (setup_.depth_to - setup_.depth_from) * x;
  return setup_.p_RP + (s_m - (1.0 - depth) * setup_.length_m) * Direction(t_s);
}

}  // namespace flextip::hidden
