#include "plausibility/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/median.h"

namespace flextip::plausibility {
namespace {

constexpr int kOrder = 6;
constexpr std::array<double, kOrder + 1> kWeights{1, -6, 15, -20, 15, -6, 1};
constexpr double kGain = 30.3974;  // root of the weights' squares
constexpr double kFactor = 3.0;    // a noise is as stated, within
constexpr double kMadeUp = 1e-3;   // of the stated noise: no sensor has so little
constexpr double kMedianToSd = 1.0 / 0.6745;
constexpr std::size_t kFewest = 30, kMany = 60;  // samples

/// Standard deviation of what differences of order 6 at `step` samples leave.
double HighFrequencySd(const std::vector<double>& x, std::size_t step) {
  std::vector<double> differences;
  for (std::size_t i = 0; i + kOrder * step < x.size(); ++i) {
    double d = 0.0;
    for (std::size_t j = 0; j <= kOrder; ++j) d += kWeights[j] * x[i + j * step];
    differences.push_back(std::abs(d) / kGain);
  }
  return kMedianToSd * Median(std::move(differences));
}

using Components = std::vector<std::vector<double>>;

bool NeverChanges(const Components& components) {
  return std::all_of(components.begin(), components.end(), [](const std::vector<double>& x) {
    return std::all_of(x.begin(), x.end(), [&x](double value) { return value == x.front(); });
  });
}

template <class Vector>
void Push(Components& components, const Vector& v) {
  if (components.empty()) components.resize(static_cast<std::size_t>(v.size()));
  for (std::size_t i = 0; i < components.size(); ++i)
    components[i].push_back(v[static_cast<Eigen::Index>(i)]);
}

/// Turns from the first orientation on, so that a small turn is a small number.
Eigen::Vector3d Turn(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  Eigen::Quaterniond turn = to * from.conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  return 2.0 * turn.vec();
}

/// Slower samples are stops: their differences are motion.
template <class T>
bool IsFast(const Series<T>& series) {
  constexpr double kSlow_hz = 5.0;
  if (series.size() < kFewest) return false;
  const double s = 1e-9 * static_cast<double>(series.back().t_ns - series.front().t_ns);
  return static_cast<double>(series.size()) > kSlow_hz * s;
}

/// A stated noise, and how it is shown.
struct Stated {
  std::string of;  ///< "positions"
  double sd = 0.0;
  const char *unit, *key;  ///< a thousandth of the SI unit; "position_noise_m: {:.2g}"
  double motion = 0.0;     ///< of the noise, commanded: the instrument moves so
};

/// A controller that listens to noisy sensors commands noise, and the instrument follows it: what
/// looks like noise of its sensors is motion. Standard deviations per component.
struct Jitter {
  double wrist_m = 0.0, turn_rad = 0.0, tip_m = 0.0;
};

Jitter CommandedJitter(const Recording& r) {
  constexpr double kLeast = 0.02;   // of the length: nearer to the port the shaft would turn round
  constexpr double kFollows = 1.5;  // both are estimates, of other rates
  Jitter jitter;
  if (!r.command0 || !r.wrist0 || r.wrist0->samples.empty()) return jitter;
  if (r.command0->p_RW.size() < kFewest) {  // too few to tell: any trembling may be commanded
    constexpr double kAny = std::numeric_limits<double>::infinity();
    return {kAny, kAny, kAny};
  }
  Components places;
  for (const auto& s : r.command0->p_RW) Push(places, s.value);
  double squares = 0.0;
  for (const auto& x : places) {
    const double sd = HighFrequencySd(x, 1);
    squares += sd * sd / static_cast<double>(places.size());
  }
  // A command that is made from the measured wrist has its noise, and the wrist does not follow
  // that.
  if (std::sqrt(squares) <= kFactor * r.wrist0->position_noise_m) return jitter;
  jitter.wrist_m = kFollows * std::sqrt(squares);
  std::vector<double> to_port;
  for (const auto& s : r.wrist0->samples) to_port.push_back((r.p_RP - s.value.p_RW).norm());
  const double length = r.instrument.length_m;
  const double before = std::max(Median(std::move(to_port)), kLeast * length);
  jitter.turn_rad = jitter.wrist_m / before;
  constexpr double kBends = 1.5;  // the tip of a bent shaft moves farther
  jitter.tip_m = kBends * jitter.wrist_m * std::max(1.0, (length - before) / before);
  return jitter;
}

class NoiseCheck {
 public:
  NoiseCheck(const std::vector<std::string>& but, const Jitter& jitter)
      : but_(but), jitter_(jitter) {}

  void Wrist(const WristStream& stream) {
    if (!IsFast(stream.samples)) return;
    Components places, turns;
    const auto& first = stream.samples.front().value.q_RW;
    for (const auto& s : stream.samples) {
      Push(places, s.value.p_RW);
      if (s.value.q_RW && first) Push(turns, Turn(*first, *s.value.q_RW));
    }
    Poses("wrist0", places, stream.position_noise_m, jitter_.wrist_m, turns,
          stream.orientation_noise_rad);
  }

  void Em(const std::string& name, const EmStream& stream) {
    if (!IsFast(stream.samples)) return;
    Components places, turns;
    for (const auto& s : stream.samples) {
      Push(places, s.value.p_RS);
      Push(turns, Turn(stream.samples.front().value.q_RS, s.value.q_RS));
    }
    Poses(name, places, stream.position_noise_m, jitter_.tip_m, turns,
          stream.orientation_noise_rad);
  }

  void Strain(const StrainStream& stream) {
    if (!IsFast(stream.moments_Nm)) return;
    Components moments;
    for (const auto& s : stream.moments_Nm) Push(moments, s.value);
    Compare("strain0", moments,
            {"moments", stream.moment_noise_Nm, "mNm", "moment_noise_Nm: {:.2g}"});
  }

  void Load(const LoadStream& stream) {
    if (!IsFast(stream.f_tip_N)) return;
    Components forces;
    for (const auto& s : stream.f_tip_N) Push(forces, s.value);
    const auto noise = NoiseOf(forces);
    if (!noise || !(noise->most > 0.0)) return;  // known, not measured
    Compare("load0", forces, {"forces", stream.force_noise_N, "mN", "force_noise_N: {:.2g}"});
  }

  void Vision(const VisionStream& stream) {
    if (!IsFast(stream.tips)) return;
    Components places, directions;
    std::vector<double> variances;
    for (const auto& s : stream.tips) {
      if (s.value.status != TipStatus::kOk) continue;
      Push(places, s.value.p_RE);
      variances.push_back(s.value.covariance_m2.trace() / 3.0);
      if (s.value.d_RE) Push(directions, *s.value.d_RE);
    }
    Compare("vision0", places,
            {"positions", std::sqrt(std::max(0.0, Median(variances))), "mm",
             "the covariance: a standard deviation of {:.2g} m an axis", jitter_.tip_m});
    if (directions.empty() || directions.front().size() != places.front().size()) return;
    // Stated across the direction: two of three components.
    Compare("vision0", directions,
            {"directions", stream.direction_noise_rad * std::sqrt(2.0 / 3.0), "mrad",
             "direction_noise_rad: {:.2g}", jitter_.turn_rad});
  }

  std::vector<Finding> findings;

 private:
  void Poses(const std::string& name, const Components& places, double place_sd_m,
             double place_jitter_m, const Components& turns, double turn_sd_rad) {
    Compare(name, places,
            {"positions", place_sd_m, "mm", "position_noise_m: {:.2g}", place_jitter_m});
    Compare(
        name, turns,
        {"orientations", turn_sd_rad, "mrad", "orientation_noise_rad: {:.2g}", jitter_.turn_rad});
  }

  void Compare(const std::string& stream, const Components& components, const Stated& stated) {
    const std::string id = stream + ".noise";
    if (!(stated.sd > 0.0) || std::count(but_.begin(), but_.end(), stream) > 0) return;
    for (const Finding& f : findings)
      if (f.id == id) return;
    const auto noise = NoiseOf(components);
    if (!noise) return;
    const double own =
        std::sqrt(std::max(0.0, noise->least * noise->least - stated.motion * stated.motion));
    const bool more = own > kFactor * stated.sd;
    if (!more && !(noise->most < stated.sd / kFactor)) return;
    if (NeverChanges(components)) {
      findings.push_back(
          {Severity::kDoubtful, id,
           fmt::format("{}: its {} never change, the file states a noise of {:.3g} {}", stream,
                       stated.of, 1e3 * stated.sd, stated.unit),
           "look whether the sensor was stuck, or the values are made up"});
      return;
    }
    const double seen = more ? own : noise->most;
    const double times = more ? seen / stated.sd : stated.sd / std::max(seen, 1e-12 * stated.sd);
    findings.push_back(
        {Severity::kDoubtful, id,
         fmt::format("{}: the noise of its {} is {:.3g} {}, the file states {:.3g} {}: {:.3g} "
                     "times {}",
                     stream, stated.of, 1e3 * seen, stated.unit, 1e3 * stated.sd, stated.unit,
                     times, more ? "more" : "less"),
         seen < kMadeUp * stated.sd
             ? "look whether the values are made up, or smoothed"
             : fmt::format("{} in {}/sensor.yaml", fmt::format(fmt::runtime(stated.key), seen),
                           stream)});
  }

  const std::vector<std::string>& but_;
  const Jitter& jitter_;
};

}  // namespace

std::optional<NoiseRange> NoiseOf(const Components& components) {
  if (components.empty() || components.front().size() < kFewest) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool many = components.front().size() >= kMany;
  // Noise that is correlated shows at large steps alone, and those need many samples.
  NoiseRange range{kInfinity, many ? 0.0 : kInfinity};
  for (const std::size_t step : {1, 2, 4}) {
    if (step > 1 && !many) break;
    double squares = 0.0, spread = 0.0;
    for (const auto& x : components) {
      const double sd = HighFrequencySd(x, step);
      squares += sd * sd / static_cast<double>(components.size());
      const double width = Quantile(x, 0.9) - Quantile(x, 0.1);
      spread += width * width / static_cast<double>(components.size());
    }
    // A motion of few samples a period looks like noise nearly as large as the motion. Noise alone
    // has a spread of 2.6 standard deviations.
    const double sd = std::sqrt(squares);
    const double ratio = sd / std::max(std::sqrt(spread), 1e-300);
    if (step == 1 && ratio > 0.08 && ratio < 0.3) return {};
    range.least = std::min(range.least, sd);
    range.most = std::max(range.most, sd);
  }
  return range;
}

std::vector<Finding> CheckNoise(const Recording& r, const std::vector<std::string>& but) {
  const Jitter jitter = CommandedJitter(r);
  NoiseCheck check(but, jitter);
  if (r.wrist0) check.Wrist(*r.wrist0);
  if (r.em0) check.Em("em0", *r.em0);
  if (r.em1) check.Em("em1", *r.em1);
  if (r.strain0) check.Strain(*r.strain0);
  if (r.load0) check.Load(*r.load0);
  if (r.vision0) check.Vision(*r.vision0);
  return check.findings;
}

}  // namespace flextip::plausibility
