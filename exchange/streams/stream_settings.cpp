#include "exchange/streams/stream_settings.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/median.h"
#include "exchange/values/times.h"
#include "recording/text/bounds.h"

namespace flextip::exchange {
namespace {

template <class T>
std::vector<TimeNs> TimesOf(const Series<T>& series) {
  std::vector<TimeNs> times;
  for (const auto& sample : series) times.push_back(sample.t_ns);
  return times;
}

template <class T, class Function>
std::vector<Eigen::VectorXd> ValuesOf(const Series<T>& series, Function value) {
  std::vector<Eigen::VectorXd> values;
  values.reserve(series.size());
  for (const auto& sample : series) values.emplace_back(value(sample.value));
  return values;
}

void TakeWrist(WristStream& stream, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(TimesOf(stream.samples));
  stream.position_noise_m = settings.Noise(
      "position_noise_m", ValuesOf(stream.samples, [](const WristSample& s) { return s.p_RW; }));
  std::vector<Eigen::Quaterniond> rotations;
  for (const auto& sample : stream.samples) {
    if (sample.value.q_RW) rotations.push_back(*sample.value.q_RW);
  }
  stream.orientation_noise_rad = rotations.empty()
                                     ? settings.Or("orientation_noise_rad", 0.0)
                                     : settings.Noise("orientation_noise_rad", rotations);
}

void TakeEm(EmStream& stream, bool on_port, double length_m, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(TimesOf(stream.samples));
  stream.distance_from_tip_m = settings.Or("distance_from_tip_m", 0.0);  // of em0 it is told
  if (!on_port && stream.distance_from_tip_m > length_m) {
    throw InputError(
        fmt::format("em0.distance_from_tip_m: found {}, expected at most the shaft's length {}",
                    stream.distance_from_tip_m, length_m));
  }
  const bool placed = !on_port || !stream.samples.front().value.p_RS.isZero() ||
                      !stream.samples.back().value.p_RS.isZero();
  stream.position_noise_m =
      placed ? settings.Noise("position_noise_m",
                              ValuesOf(stream.samples, [](const EmSample& s) { return s.p_RS; }))
             : settings.Or("position_noise_m", 0.0);
  std::vector<Eigen::Quaterniond> rotations;
  for (const auto& sample : stream.samples) rotations.push_back(sample.value.q_RS);
  stream.orientation_noise_rad = settings.Noise("orientation_noise_rad", rotations);
  if (settings.Text("noise_distribution", "gaussian") == "uniform") {
    stream.noise_distribution = NoiseDistribution::kUniform;
  }
  stream.registration_noise_rad = settings.Or("registration_noise_rad", 0.0);
  stream.registration_noise_m = settings.Or("registration_noise_m", 0.0);
}

void TakeStrain(StrainStream& stream, double length_m, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(TimesOf(stream.moments_Nm));
  const std::vector<double> s = settings.List("stations_from_wrist_m");
  if (!(0 <= s[0] && s[0] < s[1] && s[1] <= length_m)) {
    throw InputError(fmt::format(
        "strain0.stations_from_wrist_m: found [{}, {}], expected 0 <= s1 < s2 <= the shaft's "
        "length {}",
        s[0], s[1], length_m));
  }
  stream.station_from_wrist_m[0] = s[0];
  stream.station_from_wrist_m[1] = s[1];
  stream.moment_noise_Nm = settings.Noise(
      "moment_noise_Nm", ValuesOf(stream.moments_Nm, [](const Eigen::Vector4d& m) { return m; }));
}

void TakeLoad(LoadStream& stream, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(TimesOf(stream.f_tip_N));
  stream.force_noise_N = settings.Noise(
      "force_noise_N", ValuesOf(stream.f_tip_N, [](const Eigen::Vector3d& f) { return f; }));
}

}  // namespace

Settings::Settings(std::string stream, const ImportPlan& plan, ImportLog& log)
    : stream_(std::move(stream)), log_(log) {
  if (const auto found = plan.sensors.find(stream_); found != plan.sensors.end()) {
    told_ = found->second;
  }
}

NotTold Settings::MissingKey(const std::string& key) const {
  return {fmt::format("no file says {}.{}, and the values do not tell it", stream_, key),
          {fmt::format("sensors.{}.{}", stream_, key)}};
}

double Settings::Rate(const std::vector<TimeNs>& times) {
  RefuseLeaps(stream_ + ": its samples", times);
  if (const auto told = List("rate_hz"); !told.empty()) return told.front();
  std::vector<TimeNs> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) throw MissingKey("rate_hz");
  const double rate_hz = 1e9 / static_cast<double>(Median(steps));
  const std::string expected = ExpectedAbove(BoundsOf("rate_hz"), rate_hz, false);
  if (expected.empty()) return rate_hz;
  throw InputError(fmt::format("{}: its samples are {:.3g} s apart, expected a rate of {}", stream_,
                               1.0 / rate_hz, expected));
}

double Settings::Noted(const std::string& key, const std::optional<MeasuredNoise>& measured) {
  if (!measured) throw MissingKey(key);
  log_.Assume(stream_ + "." + key, fmt::format("{:.3g}, {}", measured->sd, measured->how));
  return measured->sd;
}

double Settings::Noise(const std::string& key, const std::vector<Eigen::VectorXd>& values) {
  const auto told = List(key);
  return told.empty() ? Noted(key, MeasureNoise(values)) : told.front();
}

double Settings::Noise(const std::string& key, const std::vector<Eigen::Quaterniond>& rotations) {
  const auto told = List(key);
  return told.empty() ? Noted(key, MeasureNoise(rotations)) : told.front();
}

double Settings::Or(const std::string& key, double fallback) const {
  const auto told = List(key);
  return told.empty() ? fallback : told.front();
}

std::string Settings::Text(const std::string& key, const std::string& fallback) const {
  const auto found = told_.texts.find(key);
  return found == told_.texts.end() ? fallback : found->second;
}

std::vector<double> Settings::List(const std::string& key) const {
  const auto found = told_.numbers.find(key);
  return found == told_.numbers.end() ? std::vector<double>() : found->second;
}

void TakeSettings(const ImportPlan& plan, Recording& recording, ImportLog& log) {
  const double length_m = recording.instrument.length_m;
  const auto take = [&](const char* stream, auto& part, auto take_part) {
    if (part) log.Try([&] { take_part(*part, Settings(stream, plan, log)); });
  };
  take("wrist0", recording.wrist0, TakeWrist);
  take("command0", recording.command0, [](CommandStream& stream, Settings settings) {
    stream.comment = settings.Text("comment", "imported");
    stream.rate_hz = settings.Rate(TimesOf(stream.p_RW));
  });
  take("em0", recording.em0, [&](EmStream& stream, Settings settings) {
    TakeEm(stream, false, length_m, std::move(settings));
  });
  take("em1", recording.em1, [&](EmStream& stream, Settings settings) {
    TakeEm(stream, true, length_m, std::move(settings));
  });
  take("strain0", recording.strain0, [&](StrainStream& stream, Settings settings) {
    TakeStrain(stream, length_m, std::move(settings));
  });
  take("load0", recording.load0, TakeLoad);
  log.RefuseMissing();
}

}  // namespace flextip::exchange
