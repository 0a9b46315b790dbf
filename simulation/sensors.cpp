#include "simulation/sensors.h"

#include <cmath>

#include "core/rotation.h"

namespace flextip {
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

}  // namespace

Eigen::Vector3d SensorNoise::Vector(double sd) {
  const double x = Draw(), y = Draw(), z = Draw();
  return sd * Eigen::Vector3d(x, y, z);
}

double SensorNoise::Draw() {
  if (distribution_ == NoiseDistribution::kGaussian) return normal_(rng_);
  const double half_width = std::sqrt(3.0);
  return std::uniform_real_distribution<double>(-half_width, half_width)(rng_);
}

Sensors::Channel Sensors::MakeChannel(std::uint64_t seed, int sensor,
                                      const std::optional<EmStream>& em) {
  const auto distribution = em ? em->noise_distribution : NoiseDistribution::kGaussian;
  return {SensorNoise(SeedOf(seed, sensor), distribution), kSimulationStart_ns};
}

Sensors::Sensors(const SensorSetup& setup, std::uint64_t seed)
    : setup_(setup),
      wrist_(MakeChannel(seed, 1)),
      em0_(MakeChannel(seed, 2, setup.em0)),
      em1_(MakeChannel(seed, 3, setup.em1)),
      strain_(MakeChannel(seed, 4)),
      load_(MakeChannel(seed, 5)),
      tip_(MakeChannel(seed, 6)) {}

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
  if (setup_.wrist && wrist_.Due(setup_.wrist->rate_hz, t_ns)) SampleWrist(shape, t_ns, recording);
  if (setup_.em0 && em0_.Due(setup_.em0->rate_hz, t_ns)) {
    const Pose T_RS = shape.Frame(shape.length_m - setup_.em0->distance_from_tip_m);
    SampleEm(T_RS, t_ns, *setup_.em0, em0_, recording.em0);
  }
  if (setup_.em1 && em1_.Due(setup_.em1->rate_hz, t_ns)) {
    SampleEm(shape.Frame(shape.s_port_m), t_ns, *setup_.em1, em1_, recording.em1);
  }
  if (setup_.strain && strain_.Due(setup_.strain->rate_hz, t_ns)) {
    SampleStrain(shape, t_ns, recording);
  }
  if (setup_.load && load_.Due(setup_.load->rate_hz, t_ns)) {
    LoadStream& stream = Get(recording.load0, *setup_.load);
    stream.f_tip_N.push_back({t_ns, shape.f_tip_N + load_.noise.Vector(stream.force_noise_N)});
  }
  if (setup_.tip && tip_.Due(setup_.tip->rate_hz, t_ns)) SampleTip(shape, t_ns, recording);
}

void Sensors::SampleWrist(const PlantShape& shape, TimeNs t_ns, Recording& recording) {
  WristStream& stream = Get(recording.wrist0, *setup_.wrist);
  const Pose T_RW = shape.T_RW();
  WristSample sample;
  sample.p_RW = T_RW.p + wrist_.noise.Vector(stream.position_noise_m);
  const Eigen::Vector3d turn = wrist_.noise.Vector(stream.orientation_noise_rad);
  sample.q_RW = Pose{ExpRotation(turn) * T_RW.R, T_RW.p}.Quaternion();
  stream.samples.push_back({t_ns, sample});
}

void Sensors::SampleEm(const Pose& T_RS, TimeNs t_ns, const EmStream& setup, Channel& channel,
                       std::optional<EmStream>& stream) {
  EmSample sample;
  sample.p_RS = T_RS.p + channel.noise.Vector(setup.position_noise_m);
  const Eigen::Vector3d turn = channel.noise.Vector(setup.orientation_noise_rad);
  sample.q_RS = Pose{ExpRotation(turn) * T_RS.R, T_RS.p}.Quaternion();
  Get(stream, setup).samples.push_back({t_ns, sample});
}

void Sensors::SampleStrain(const PlantShape& shape, TimeNs t_ns, Recording& recording) {
  StrainStream& stream = Get(recording.strain0, *setup_.strain);
  Eigen::Vector4d moments;
  for (int i = 0; i < 2; ++i) {
    const double s = stream.station_from_wrist_m[i];
    const Eigen::Vector3d local = shape.Frame(s).R.transpose() * shape.Moment(s);
    const Eigen::Vector3d noise = strain_.noise.Vector(stream.moment_noise_Nm);
    moments.segment<2>(2 * i) = local.tail<2>() + noise.head<2>();
  }
  stream.moments_Nm.push_back({t_ns, moments});
}

void Sensors::SampleTip(const PlantShape& shape, TimeNs t_ns, Recording& recording) {
  const TipSensorSetup& setup = *setup_.tip;
  if (!recording.vision0) {
    recording.vision0.emplace();
    recording.vision0->comment = "tip tracker, simulated by its figures";
    recording.vision0->rate_hz = setup.rate_hz;
    recording.vision0->direction_noise_rad = setup.direction_noise_rad;
  }
  const Eigen::Vector3d& depth = setup.line_of_sight;
  const Eigen::Matrix3d square_root =
      setup.across_noise_m * Eigen::Matrix3d::Identity() +
      (setup.depth_noise_m - setup.across_noise_m) * depth * depth.transpose();
  const Pose T_RE = shape.T_RE();
  TipObservation tip;
  tip.status = TipStatus::kOk;
  tip.covariance_m2 = square_root * square_root;
  tip.p_RE = T_RE.p + square_root * tip_.noise.Vector(1.0);
  tip.d_RE = ExpRotation(tip_.noise.Vector(setup.direction_noise_rad)) * T_RE.R.col(0);
  recording.vision0->tips.push_back({t_ns, tip});
}

}  // namespace flextip
