#include "exchange/import.h"

#include <fmt/format.h>

#include <cmath>
#include <system_error>
#include <utility>

#include "core/median.h"
#include "exchange/formats/formats.h"
#include "exchange/mapping_file.h"
#include "exchange/sensor_settings.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

void CheckInstrument(const ImportPlan& plan) {
  std::vector<std::string> keys;
  const auto need = [&](bool there, const char* key) {
    if (!there) keys.emplace_back(key);
  };
  need(plan.length_m.has_value(), "instrument.length_m");
  need(plan.outer_diameter_m.has_value(), "instrument.outer_diameter_m");
  need(plan.bending_stiffness_Nm2.has_value(), "instrument.bending_stiffness_Nm2");
  need(plan.p_RP.has_value(), "port.position_m");
  if (keys.empty()) return;
  throw NotTold(fmt::format("no file says {}, and a recording needs it", fmt::join(keys, ", ")),
                keys);
}

void TakeInstrument(ImportPlan& plan, Recording& recording, ImportLog& log) {
  if (!plan.mass_per_length_kg_m) {
    plan.mass_per_length_kg_m = 0.0;
    log.Assume("instrument.mass_per_length_kg_m", "0: the shaft's own weight is not modelled");
  }
  if (!plan.gravity_m_s2) {
    plan.gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -9.81);
    log.Assume("gravity_m_s2", "0, 0, -9.81: R's z axis points up");
  }
  recording.instrument = {*plan.length_m, *plan.outer_diameter_m, *plan.bending_stiffness_Nm2,
                          *plan.mass_per_length_kg_m, plan.stiffness_taper.value_or(0.0)};
  recording.p_RP = *plan.p_RP;
  recording.gravity_m_s2 = *plan.gravity_m_s2;
  recording.tolerances = plan.tolerances;
}

/// The settings of one stream: told, measured or missing.
class Settings {
 public:
  Settings(std::string stream, const ImportPlan& plan, ImportLog& log)
      : stream_(std::move(stream)), log_(log) {
    if (const auto found = plan.sensors.find(stream_); found != plan.sensors.end()) {
      told_ = found->second;
    }
  }

  template <class T>
  double Rate(const Series<T>& series) {
    if (const auto told = Told("rate_hz")) return *told;
    std::vector<TimeNs> steps;
    for (std::size_t i = 1; i < series.size(); ++i) {
      steps.push_back(series[i].t_ns - series[i - 1].t_ns);
    }
    if (steps.empty()) throw Missing("rate_hz");
    const double rate_hz = 1e9 / static_cast<double>(Median(steps));
    log_.Assume(stream_ + ".rate_hz", fmt::format("{:.6g}, by the median of its steps", rate_hz));
    return rate_hz;
  }

  double Noise(const std::string& key, const std::vector<Eigen::VectorXd>& values, double factor) {
    if (const auto told = Told(key)) return *told;
    const auto measured = MeasuredNoise(values);
    if (!measured) throw Missing(key);
    log_.Assume(
        stream_ + "." + key,
        fmt::format("{:.3g}, measured by the values' third differences", *measured * factor));
    return *measured * factor;
  }

  double Needed(const std::string& key) {
    const auto told = Told(key);
    if (!told) throw Missing(key);
    return *told;
  }

  double Or(const std::string& key, double fallback) { return Told(key).value_or(fallback); }

  std::string Text(const std::string& key, const std::string& fallback) const {
    const auto found = told_.texts.find(key);
    return found == told_.texts.end() ? fallback : found->second;
  }

  const std::vector<double>& List(const std::string& key) {
    const auto found = told_.numbers.find(key);
    if (found == told_.numbers.end()) throw Missing(key);
    return found->second;
  }

  NotTold Missing(const std::string& key) const {
    return {fmt::format("{}: no file says {}, and its values do not tell it", stream_, key),
            {"sensors." + stream_ + "." + key}};
  }

 private:
  std::optional<double> Told(const std::string& key) const {
    const auto found = told_.numbers.find(key);
    if (found == told_.numbers.end()) return {};
    return found->second.front();
  }

  std::string stream_;
  ImportLog& log_;
  SensorSettings told_;
};

template <class T, class Function>
std::vector<Eigen::VectorXd> Values(const Series<T>& series, Function value) {
  std::vector<Eigen::VectorXd> values;
  values.reserve(series.size());
  for (const auto& sample : series) values.push_back(value(sample.value));
  return values;
}

// Quaternions of one sign.
std::vector<Eigen::VectorXd> Turns(const std::vector<Eigen::Quaterniond>& orientations) {
  std::vector<Eigen::VectorXd> turns;
  Eigen::Vector4d last = Eigen::Vector4d::Zero();
  for (const auto& q : orientations) {
    Eigen::Vector4d now = q.coeffs();
    if (now.dot(last) < 0) now = -now;
    turns.emplace_back(now);
    last = now;
  }
  return turns;
}

// A rotation's noise moves the quaternion by half of it, along three of its four components: the
// ratio of the medians of chi-square with four and with three degrees of freedom.
const double kTurnFactor = 2.0 * std::sqrt(3.357 / 2.366);

void TakeWristSettings(WristStream& stream, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(stream.samples);
  stream.position_noise_m = settings.Noise(
      "position_noise_m", Values(stream.samples, [](const WristSample& s) { return s.p_RW; }), 1.0);
  std::vector<Eigen::Quaterniond> orientations;
  for (const auto& sample : stream.samples) {
    if (sample.value.q_RW) orientations.push_back(*sample.value.q_RW);
  }
  stream.orientation_noise_rad =
      orientations.empty()
          ? settings.Or("orientation_noise_rad", 0.0)
          : settings.Noise("orientation_noise_rad", Turns(orientations), kTurnFactor);
}

void TakeEmSettings(EmStream& stream, bool on_port, double length_m, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(stream.samples);
  stream.distance_from_tip_m =
      on_port ? settings.Or("distance_from_tip_m", 0.0) : settings.Needed("distance_from_tip_m");
  if (!on_port && stream.distance_from_tip_m > length_m) {
    throw InputError(
        fmt::format("em0.distance_from_tip_m: found {}, expected at most the shaft's "
                    "length {}",
                    stream.distance_from_tip_m, length_m));
  }
  const bool still = on_port && stream.samples.front().value.p_RS.isZero() &&
                     stream.samples.back().value.p_RS.isZero();
  stream.position_noise_m =
      still ? settings.Or("position_noise_m", 0.0)
            : settings.Noise("position_noise_m",
                             Values(stream.samples, [](const EmSample& s) { return s.p_RS; }), 1.0);
  std::vector<Eigen::Quaterniond> orientations;
  for (const auto& sample : stream.samples) orientations.push_back(sample.value.q_RS);
  stream.orientation_noise_rad =
      settings.Noise("orientation_noise_rad", Turns(orientations), kTurnFactor);
  if (settings.Text("noise_distribution", "gaussian") == "uniform") {
    stream.noise_distribution = NoiseDistribution::kUniform;
  }
  stream.registration_noise_rad = settings.Or("registration_noise_rad", 0.0);
  stream.registration_noise_m = settings.Or("registration_noise_m", 0.0);
}

void TakeStrainSettings(StrainStream& stream, double length_m, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(stream.moments_Nm);
  const auto& s = settings.List("stations_from_wrist_m");
  if (!(0 <= s[0] && s[0] < s[1] && s[1] <= length_m)) {
    throw InputError(
        fmt::format("strain0.stations_from_wrist_m: found [{}, {}], expected 0 <= s1 < "
                    "s2 <= the shaft's length {}",
                    s[0], s[1], length_m));
  }
  stream.station_from_wrist_m[0] = s[0];
  stream.station_from_wrist_m[1] = s[1];
  stream.moment_noise_Nm =
      settings.Noise("moment_noise_Nm",
                     Values(stream.moments_Nm, [](const Eigen::Vector4d& m) { return m; }), 1.0);
}

void TakeLoadSettings(LoadStream& stream, Settings settings) {
  stream.comment = settings.Text("comment", "imported");
  stream.rate_hz = settings.Rate(stream.f_tip_N);
  stream.force_noise_N = settings.Noise(
      "force_noise_N", Values(stream.f_tip_N, [](const Eigen::Vector3d& f) { return f; }), 1.0);
}

void TakeSettings(Recording& recording, const ImportPlan& plan, ImportLog& log) {
  const double length_m = recording.instrument.length_m;
  if (recording.wrist0) TakeWristSettings(*recording.wrist0, {"wrist0", plan, log});
  if (recording.command0) {
    Settings settings("command0", plan, log);
    recording.command0->comment = settings.Text("comment", "imported");
    recording.command0->rate_hz = settings.Rate(recording.command0->p_RW);
  }
  if (recording.em0) TakeEmSettings(*recording.em0, false, length_m, {"em0", plan, log});
  if (recording.em1) TakeEmSettings(*recording.em1, true, length_m, {"em1", plan, log});
  if (recording.strain0) TakeStrainSettings(*recording.strain0, length_m, {"strain0", plan, log});
  if (recording.load0) TakeLoadSettings(*recording.load0, {"load0", plan, log});
}

// Clocks that differ by more than the recording is long leave streams without a common time.
void SayApart(const Recording& recording, ImportLog& log) {
  const auto streams = DescribeStreams(recording);
  for (std::size_t i = 1; i < streams.size(); ++i) {
    const auto &a = streams[0], &b = streams[i];
    if (a.first_ns <= b.last_ns && b.first_ns <= a.last_ns) continue;
    log.Warn(
        fmt::format("{} and {} have no time in common (they begin {:.6g} s apart): their clocks "
                    "differ, tell the offset of one",
                    a.name, b.name, 1e-9 * static_cast<double>(b.first_ns - a.first_ns)));
  }
}

std::string VectorText(const Eigen::VectorXd& v) {
  std::string text;
  for (const double value : v) text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", value);
  return text;
}

std::string TurnText(const Eigen::Quaterniond& q) {
  return fmt::format(", w x y z {:.6g}, {:.6g}, {:.6g}, {:.6g}", q.w(), q.x(), q.y(), q.z());
}

template <class T, class Function>
void Describe(const std::string& name, double rate_hz, const Series<T>& series, Function text,
              std::vector<StreamLine>& lines) {
  if (series.empty()) return;
  lines.push_back({name, series.size(), series.front().t_ns, series.back().t_ns, rate_hz,
                   text(series.front().value)});
}

}  // namespace

Imported Import(ImportPlan plan) {
  CheckInstrument(plan);
  Imported imported;
  imported.log.assumed = std::exchange(plan.assumed, {});
  Streams streams;
  ReadCsv(plan, streams, imported.log);
  if (plan.video) ReadVideoFile(plan, streams, imported.log);
  imported.recording = std::move(streams.recording);
  imported.skipped = std::move(streams.skipped);
  imported.files = std::move(streams.files);
  TakeInstrument(plan, imported.recording, imported.log);
  TakeSettings(imported.recording, plan, imported.log);
  SayApart(imported.recording, imported.log);
  plan.assumed = imported.log.assumed;
  imported.plan = std::move(plan);
  return imported;
}

void WriteImported(const fs::path& folder, const Imported& imported) {
  WriteRecording(folder, imported.recording);
  const bool link = imported.plan.video && imported.plan.video->link;
  for (const auto& [from, to] : imported.files) {
    std::error_code error;
    fs::create_directories((folder / to).parent_path(), error);
    if (link) {
      fs::create_symlink(from, folder / to, error);
    } else {
      fs::copy_file(from, folder / to, error);
    }
    if (error) {
      throw WorkError(
          fmt::format("{}: cannot be put into the recording: {}", from.string(), error.message()));
    }
  }
  WriteTextFile(folder / kMappingName, MappingText(imported.plan));
}

std::vector<StreamLine> DescribeStreams(const Recording& r) {
  std::vector<StreamLine> lines;
  const auto vector = [](const auto& v) { return VectorText(v); };
  const auto em = [](const EmSample& s) { return VectorText(s.p_RS) + " m" + TurnText(s.q_RS); };
  if (r.wrist0) {
    Describe(
        "wrist0", r.wrist0->rate_hz, r.wrist0->samples,
        [](const WristSample& s) {
          return VectorText(s.p_RW) + " m" +
                 (s.q_RW ? TurnText(*s.q_RW) : ", orientation not measured");
        },
        lines);
  }
  if (r.command0) {
    Describe(
        "command0", r.command0->rate_hz, r.command0->p_RW,
        [&](const auto& v) { return vector(v) + " m"; }, lines);
  }
  if (r.em0) Describe("em0", r.em0->rate_hz, r.em0->samples, em, lines);
  if (r.em1) Describe("em1", r.em1->rate_hz, r.em1->samples, em, lines);
  if (r.strain0) {
    Describe(
        "strain0", r.strain0->rate_hz, r.strain0->moments_Nm,
        [&](const auto& v) { return vector(v) + " Nm"; }, lines);
  }
  if (r.load0) {
    Describe(
        "load0", r.load0->rate_hz, r.load0->f_tip_N,
        [&](const auto& v) { return vector(v) + " N"; }, lines);
  }
  if (r.cam0) {
    Describe(
        "cam0", r.cam0->calibration.rate_hz, r.cam0->frame_numbers,
        [](int frame) { return fmt::format("frame {}", frame); }, lines);
  }
  return lines;
}

}  // namespace flextip::exchange
