// Recordings of an instrument that moves at random through a port, with clocks that are off.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/draw_vector.h"
#include "recording/recording.h"

namespace flextip {

/// Reference time = t + offset + rate (t - origin), in seconds since kClockStart_ns.
struct TrueClock {
  double offset_s = 0.0, rate = 0.0, origin_s = 0.0;
  double ReferenceTime(double t) const { return t + offset_s + rate * (t - origin_s); }
  double OwnTime(double reference_s) const {
    return (reference_s - offset_s + rate * origin_s) / (1.0 + rate);
  }
};

struct ClockScene {
  double seconds = 60.0;
  double speed = 1.0;  ///< of the motion; 0: it stands still
  double em_noise_m = 5e-4, wrist_noise_m = 2e-5, strain_noise_Nm = 1e-3, jitter_s = 0.0;
  double remembered = 0.0;    ///< correlation of the EM sensor's noise from sample to sample
  bool periodic = false;      ///< the same two seconds again and again
  bool em_elsewhere = false;  ///< the EM sensor moves on its own
  double play_m = 0.0;        ///< full width, per axis, between the measured wrist and the shaft's
  double breath_m = 0.0;      ///< the port goes up and down by so much, every 3.7 s
  TrueClock em = {}, vision = {}, strain = {};
};

inline constexpr TimeNs kClockStart_ns = 1'700'000'000'000'000'000;

/// A smooth path of six numbers, of waves with random frequencies up to 1.2 Hz.
class RandomPath {
 public:
  RandomPath(bool periodic, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int k = 0; k < 14; ++k) {
      const double hz = periodic ? 0.5 * (1 + k % 2) : 0.04 * std::pow(30.0, unit(random));
      Eigen::Matrix<double, 6, 2> wave;
      for (int i = 0; i < 12; ++i) wave.data()[i] = (unit(random) - 0.5) / (1.0 + hz);
      waves_.push_back({2.0 * std::numbers::pi * hz, wave});
    }
  }
  Eigen::Matrix<double, 6, 1> At(double t) const {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (const auto& [w, wave] : waves_)
      sum += wave * Eigen::Vector2d(std::sin(w * t), std::cos(w * t));
    return sum;
  }

 private:
  std::vector<std::pair<double, Eigen::Matrix<double, 6, 2>>> waves_;
};

/// A point that follows another one at a distance of half the play per axis, on a grid of 1 ms.
class DraggedWrist {
 public:
  template <class Driver>
  DraggedWrist(const Driver& driver, double play_m, double seconds) {
    Eigen::Vector3d at = driver(0.0);
    for (int i = 0; i <= static_cast<int>(1e3 * seconds) + 1; ++i) {
      const Eigen::Vector3d to = driver(1e-3 * i);
      for (int k = 0; k < 3; ++k) {
        if (to[k] - at[k] > 0.5 * play_m) at[k] = to[k] - 0.5 * play_m;
        if (at[k] - to[k] > 0.5 * play_m) at[k] = to[k] + 0.5 * play_m;
      }
      places_.push_back(at);
    }
  }
  Eigen::Vector3d At(double t) const {
    const auto i = static_cast<std::size_t>(1e3 * t);
    const double u = 1e3 * t - static_cast<double>(i);
    return (1.0 - u) * places_[i] + u * places_[i + 1];
  }

 private:
  std::vector<Eigen::Vector3d> places_;
};

/// wrist0 at 100 Hz (the reference), em0 at 40 Hz in a frame of its own, vision0 at 30 Hz, load0 at
/// 50 Hz by the wrist's clock, strain0 at 80 Hz.
inline Recording DrawClocks(const ClockScene& scene, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const RandomPath path(scene.periodic, random), other(false, random);
  const auto draw = [&] { return DrawVector<3>(normal, random); };
  Recording r;
  r.instrument.length_m = 0.6;
  r.p_RP = {0.28, 0.0, 0.0};
  const auto wrist = [&](double t) -> Eigen::Vector3d {
    return 0.02 * scene.speed * path.At(t).head<3>();
  };
  const auto force = [&](double t) -> Eigen::Vector3d {
    return 0.5 * scene.speed * path.At(t).tail<3>();
  };
  const DraggedWrist moved(wrist, scene.play_m, scene.seconds);
  const auto on_shaft = [&](double t, double from_wrist_m) -> Eigen::Vector3d {
    const Eigen::Vector3d p_RW = scene.play_m > 0.0 ? moved.At(t) : wrist(t);
    const double breath_m = scene.breath_m * std::sin(2.0 * std::numbers::pi * t / 3.7);
    const Eigen::Vector3d p_RP = r.p_RP + Eigen::Vector3d(0.0, 0.6, 0.8) * breath_m;
    return p_RW + from_wrist_m * (p_RP - p_RW).normalized();
  };
  const auto each = [&](const TrueClock& clock, double rate_hz, const auto& add) {
    double next = 0.05;
    while (next < scene.seconds) {
      const double own = clock.OwnTime(next);
      add(kClockStart_ns + std::llround(1e9 * (own + scene.jitter_s * normal(random))), next);
      next += 1.0 / rate_hz;
    }
  };
  r.wrist0.emplace();
  each({}, 100.0, [&](TimeNs t_ns, double t) {
    r.wrist0->samples.push_back({t_ns, {wrist(t) + scene.wrist_noise_m * draw(), std::nullopt}});
  });
  r.em0.emplace();
  r.em0->distance_from_tip_m = 0.03;
  r.em0->position_noise_m = scene.em_noise_m;
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  Eigen::Vector3d noise = draw();
  each(scene.em, 40.0, [&](TimeNs t_ns, double t) {
    const double fresh = std::sqrt(1.0 - scene.remembered * scene.remembered);
    noise = scene.remembered * noise + fresh * draw();
    const Eigen::Vector3d p =
        scene.em_elsewhere ? Eigen::Vector3d(0.02 * other.At(t).head<3>()) : on_shaft(t, 0.57);
    r.em0->samples.push_back(
        {t_ns,
         {turned * p + Eigen::Vector3d(0.4, 0.1, -0.2) + scene.em_noise_m * noise,
          Eigen::Quaterniond::Identity()}});
  });
  r.vision0.emplace();
  each(scene.vision, 30.0, [&](TimeNs t_ns, double t) {
    const Eigen::Vector3d sd(3e-5, 3e-5, 3e-4);
    TipObservation tip;
    tip.status = TipStatus::kOk;
    tip.p_RE = on_shaft(t, 0.6) + sd.cwiseProduct(draw());
    tip.covariance_m2 = sd.cwiseAbs2().asDiagonal();
    r.vision0->tips.push_back({t_ns, tip});
  });
  r.load0.emplace();
  each({}, 50.0, [&](TimeNs t_ns, double t) {
    r.load0->f_tip_N.push_back({t_ns, force(t) + 0.01 * draw()});
  });
  r.strain0.emplace();
  each(scene.strain, 80.0, [&](TimeNs t_ns, double t) {
    const Eigen::Vector3d f = force(t);
    Eigen::Vector4d moments(-0.3 * f.z(), 0.3 * f.y(), -0.1 * f.z(), 0.1 * f.y());
    for (int i = 0; i < 4; ++i) moments[i] += scene.strain_noise_Nm * normal(random);
    r.strain0->moments_Nm.push_back({t_ns, moments});
  });
  return r;
}

}  // namespace flextip
