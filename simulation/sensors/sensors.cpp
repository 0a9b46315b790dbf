#include "simulation/sensors/sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rotation.h"
#include "simulation/sensors/camera_view.h"

namespace flextip::simulation {
namespace {

/// Independent seeds from one: each sensor keeps its noise whatever other sensors there are.
std::uint64_t SeedOf(std::uint64_t seed, int sensor) {
  std::seed_seq sequence{seed & 0xffffffffu, seed >> 32, std::uint64_t(sensor)};
  std::uint32_t words[2];
  sequence.generate(words, words + 2);
  return std::uint64_t(words[0]) << 32 | words[1];
}

template <class Stream>
Stream& Get(std::optional<Stream>& in_recording, const Stream& setup) {
  if (!in_recording) in_recording = setup;
  return *in_recording;
}

TimeNs Nanoseconds(double t_s) { return std::llround(t_s * 1e9); }

double SinceStart_s(TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns - kSimulationStart_ns); }

/// The stamp that a clock with a rate of its own gives to `t_ns`.
TimeNs StampOf(TimeNs t_ns, double rate) {
  return t_ns - Nanoseconds(SinceStart_s(t_ns) * rate / (1.0 + rate));
}

Eigen::Vector3d Swing(const Interference& motor, TimeNs t_ns) {
  if (motor.amplitude_m.isZero(0.0)) return Eigen::Vector3d::Zero();
  const double turns = motor.frequency_hz * SinceStart_s(t_ns);
  return std::sin(2.0 * std::numbers::pi * turns + motor.phase_rad) * motor.amplitude_m;
}

}  // namespace

double SamplesPerSecond(const SensorSetup& setup) {
  double rate_hz = 0.0;
  const auto add = [&](const auto& sensor) { rate_hz += sensor ? sensor->rate_hz : 0.0; };
  add(setup.wrist), add(setup.em0), add(setup.em1);
  add(setup.strain), add(setup.load), add(setup.tip);
  return rate_hz;
}

Eigen::Vector3d SensorNoise::Vector(double sd, int which) {
  const double x = Draw(), y = Draw(), z = Draw();
  Eigen::Vector3d noise(x, y, z);
  std::optional<Eigen::Vector3d>& last = last_[which];
  if (correlation_ != 0.0 && last) {
    noise = correlation_ * *last + std::sqrt(1.0 - correlation_ * correlation_) * noise;
  }
  last = noise;
  return scale_ * sd * noise;
}

double SensorNoise::Draw() {
  if (distribution_ == NoiseDistribution::kGaussian) return normal_(rng_);
  const double half_width = std::sqrt(3.0);
  return std::uniform_real_distribution<double>(-half_width, half_width)(rng_);
}

Sensors::Channel Sensors::MakeChannel(std::uint64_t seed, int sensor,
                                      const std::optional<EmStream>& em) const {
  const auto distribution = em ? em->noise_distribution : NoiseDistribution::kGaussian;
  return {SensorNoise(SeedOf(seed, sensor), distribution, effects_.noise_scale,
                      effects_.noise_correlation),
          kSimulationStart_ns};
}

Sensors::Sensors(const SensorSetup& setup, std::uint64_t seed, const SensorEffects& effects)
    : setup_(setup),
      effects_(effects),
      em_field_(effects.em_gradient, effects.em_centre_m, effects.em_curvature),
      wrist_(MakeChannel(seed, 1)),
      em0_(MakeChannel(seed, 2, setup.em0)),
      em1_(MakeChannel(seed, 3, setup.em1)),
      strain_(MakeChannel(seed, 4)),
      load_(MakeChannel(seed, 5)),
      tip_(MakeChannel(seed, 6)) {}

void Sensors::SetEffects(const SensorEffects& effects) {
  effects_ = effects;
  em_field_ = EmField(effects.em_gradient, effects.em_centre_m, effects.em_curvature);
}

bool Sensors::Channel::Due(double rate_hz, TimeNs t_ns) {
  constexpr TimeNs kRounding_ns = 1000;
  if (t_ns + kRounding_ns < next_ns) return false;
  // Multiples of the period from the start, so that rounding does not add up.
  const double period_ns = 1e9 / rate_hz;
  const double count = std::round(static_cast<double>(next_ns - kSimulationStart_ns) / period_ns);
  next_ns = kSimulationStart_ns + std::llround((count + 1.0) * period_ns);
  return true;
}

void Sensors::Sample(const PlantShape& shape, TimeNs t_ns, Recording& recording) {
  Remember(shape, t_ns);
  if (setup_.wrist && wrist_.Due(setup_.wrist->rate_hz, t_ns)) {
    SampleWrist({shape.T_RW().R, shape.p_RW_measured}, t_ns, recording);
  }
  const TimeNs em_ns = t_ns - Nanoseconds(effects_.em_latency_s);
  if (setup_.em0 && em0_.Due(setup_.em0->rate_hz, t_ns)) {
    SampleEm(em0_history_.At(em_ns), t_ns, *setup_.em0, em0_, recording.em0);
  }
  if (setup_.em1 && em1_.Due(setup_.em1->rate_hz, t_ns)) {
    SampleEm(em1_history_.At(em_ns), t_ns, *setup_.em1, em1_, recording.em1);
  }
  if (setup_.strain && strain_.Due(setup_.strain->rate_hz, t_ns)) {
    SampleStrain(shape, t_ns, recording);
  }
  if (setup_.load && load_.Due(setup_.load->rate_hz, t_ns)) {
    LoadStream& stream = Get(recording.load0, *setup_.load);
    const Eigen::Vector3d read_N =
        effects_.load_scale * (ExpRotation(effects_.load_rotation_rad) * shape.f_tip_N);
    stream.f_tip_N.push_back({t_ns, read_N + load_.noise.Vector(stream.force_noise_N)});
  }
  if (setup_.tip && tip_.Due(setup_.tip->rate_hz, t_ns)) {
    SampleTip(tip_history_.At(t_ns - Nanoseconds(effects_.camera_latency_s)), t_ns, recording);
  }
}

std::optional<TimeNs> Sensors::NextDue() const {
  std::optional<TimeNs> next;
  const auto consider = [&](const auto& sensor, const Channel& channel) {
    if (sensor) next = std::min(next.value_or(channel.next_ns), channel.next_ns);
  };
  consider(setup_.wrist, wrist_);
  consider(setup_.em0, em0_);
  consider(setup_.em1, em1_);
  consider(setup_.strain, strain_);
  consider(setup_.load, load_);
  consider(setup_.tip, tip_);
  return next;
}

void Sensors::Remember(const PlantShape& shape, TimeNs t_ns) {
  if (setup_.em0) {
    em0_history_.Add(t_ns, shape.Frame(shape.length_m - setup_.em0->distance_from_tip_m));
  }
  if (setup_.em1) em1_history_.Add(t_ns, shape.Frame(shape.s_port_m));
  if (setup_.tip) tip_history_.Add(t_ns, shape.T_RE());
}

void Sensors::SampleWrist(const Pose& T_RW, TimeNs t_ns, Recording& recording) {
  WristStream& stream = Get(recording.wrist0, *setup_.wrist);
  WristSample sample;
  sample.p_RW = T_RW.p + wrist_.noise.Vector(stream.position_noise_m);
  const Eigen::Vector3d turn = wrist_.noise.Vector(stream.orientation_noise_rad, 1);
  sample.q_RW = Pose{ExpRotation(turn) * T_RW.R, T_RW.p}.Quaternion();
  stream.samples.push_back({t_ns, sample});
}

void Sensors::SampleEm(const Pose& T_RS, TimeNs t_ns, const EmStream& setup, Channel& channel,
                       std::optional<EmStream>& stream) {
  EmSample sample;
  sample.p_RS = T_RS.p + em_field_.Bias(T_RS.p) + effects_.em_offset_m +
                Swing(effects_.em_interference, t_ns) +
                channel.noise.Vector(setup.position_noise_m);
  const Eigen::Vector3d turn = channel.noise.Vector(setup.orientation_noise_rad, 1);
  sample.q_RS = Pose{ExpRotation(turn) * T_RS.R, T_RS.p}.Quaternion();
  Get(stream, setup).samples.push_back({StampOf(t_ns, effects_.em_clock_rate), sample});
}

void Sensors::SampleStrain(const PlantShape& shape, TimeNs t_ns, Recording& recording) {
  StrainStream& stream = Get(recording.strain0, *setup_.strain);
  Eigen::Vector4d bends, noise;
  const Eigen::Matrix3d gages =
      ExpRotation(effects_.gage_rotation_rad * Eigen::Vector3d::UnitX()).transpose();
  for (int i = 0; i < 2; ++i) {
    const double s = stream.station_from_wrist_m[i];
    const Eigen::Vector3d local = shape.Frame(s).R.transpose() * shape.Moment(s);
    bends.segment<2>(2 * i) = (gages * local).tail<2>();
    noise.segment<2>(2 * i) = strain_.noise.Vector(stream.moment_noise_Nm, i).head<2>();
  }
  Eigen::Vector4d moments = effects_.strain_gain.cwiseProduct(bends);
  moments += effects_.strain_crosstalk * bends;
  moments += noise;
  moments += SinceStart_s(t_ns) * effects_.strain_drift_Nm_s;
  const double limit = effects_.strain_limit_Nm;
  moments = moments.cwiseMax(-limit).cwiseMin(limit);
  stream.moments_Nm.push_back({t_ns, moments});
}

void Sensors::SampleTip(const Pose& T_RE, TimeNs t_ns, Recording& recording) {
  const TipSensorSetup& setup = *setup_.tip;
  if (!recording.vision0) {
    recording.vision0.emplace();
    recording.vision0->comment = setup.comment;
    recording.vision0->rate_hz = setup.rate_hz;
    recording.vision0->direction_noise_rad = setup.direction_noise_rad;
  }
  const Eigen::Vector3d& depth = setup.line_of_sight;
  const Eigen::Matrix3d square_root =
      setup.across_noise_m * Eigen::Matrix3d::Identity() +
      (setup.depth_noise_m - setup.across_noise_m) * depth * depth.transpose();
  const Pose seen = SeenTip(T_RE, setup.T_RC, effects_, SinceStart_s(t_ns));
  TipObservation tip;
  tip.status = TipStatus::kOk;
  // A recording keeps one half of it: the loop must have the same numbers.
  const Eigen::Matrix3d squared = square_root * square_root;
  tip.covariance_m2 = squared.selfadjointView<Eigen::Upper>();
  tip.p_RE = seen.p + square_root * tip_.noise.Vector(1.0);
  tip.d_RE = ExpRotation(tip_.noise.Vector(setup.direction_noise_rad, 1)) * seen.R.col(0);
  recording.vision0->tips.push_back({StampOf(t_ns, effects_.camera_clock_rate), tip});
}

}  // namespace flextip::simulation
