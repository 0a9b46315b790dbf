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
constexpr double kMedianToSd = 1.0 / 0.6745;

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

class NoiseCheck {
 public:
  explicit NoiseCheck(const std::vector<std::string>& but) : but_(but) {}

  void Compare(const std::string& stream, const std::string& what, const Components& components,
               double stated, const std::string& unit, double scale, const std::string& key) {
    if (!(stated > 0.0) || std::count(but_.begin(), but_.end(), stream) > 0) return;
    const auto noise = NoiseOf(components);
    if (!noise) return;
    constexpr double kFactor = 3.0;
    const std::string id = stream + ".noise";
    for (const Finding& f : findings)
      if (f.id == id) return;
    const bool more = noise->least > kFactor * stated, less = noise->most < stated / kFactor;
    if (!more && !less) return;
    const double seen = more ? noise->least : noise->most;
    findings.push_back(
        {Severity::kDoubtful, id,
         fmt::format(
             "{}: the noise of its {} is {:.3g} {}, the file states {:.3g} {}: {:.3g} times "
             "{}",
             stream, what, scale * seen, unit, scale * stated, unit,
             more ? seen / stated : stated / std::max(seen, 1e-12 * stated),
             more ? "more" : "less"),
         fmt::format("{} in {}/sensor.yaml", fmt::format(fmt::runtime(key), seen), stream)});
  }

  std::vector<Finding> findings;

 private:
  const std::vector<std::string>& but_;
};

}  // namespace

std::optional<NoiseRange> NoiseOf(const Components& components) {
  if (components.empty() || components.front().size() < 60) return {};
  NoiseRange range{std::numeric_limits<double>::infinity(), 0.0};
  for (const std::size_t step : {1, 2, 4}) {
    double squares = 0.0, spread = 0.0;
    for (const auto& x : components) {
      const double sd = HighFrequencySd(x, step);
      squares += sd * sd / static_cast<double>(components.size());
      const double width = Quantile(x, 0.9) - Quantile(x, 0.1);
      spread += width * width / static_cast<double>(components.size());
    }
    // Stops in place of a motion look like noise as large as the motion. Noise alone has a spread
    // of 2.6 standard deviations.
    const double sd = std::sqrt(squares);
    const double ratio = sd / std::max(std::sqrt(spread), 1e-300);
    if (step == 1 && ratio > 0.08 && ratio < 0.3) return {};
    range.least = std::min(range.least, sd);
    range.most = std::max(range.most, sd);
  }
  return range;
}

std::vector<Finding> CheckNoise(const Recording& r, const std::vector<std::string>& but) {
  constexpr double kSlow_hz = 5.0;  // slower samples are stops: differences are motion
  NoiseCheck check(but);
  const auto fast = [&](const auto& series) {
    if (series.size() < 60) return false;
    const double s = 1e-9 * static_cast<double>(series.back().t_ns - series.front().t_ns);
    return static_cast<double>(series.size()) > kSlow_hz * s;
  };
  if (r.wrist0 && fast(r.wrist0->samples)) {
    Components places, turns;
    for (const auto& s : r.wrist0->samples) {
      Push(places, s.value.p_RW);
      if (s.value.q_RW && r.wrist0->samples.front().value.q_RW)
        Push(turns, Turn(*r.wrist0->samples.front().value.q_RW, *s.value.q_RW));
    }
    check.Compare("wrist0", "positions", places, r.wrist0->position_noise_m, "mm", 1e3,
                  "position_noise_m: {:.2g}");
    check.Compare("wrist0", "orientations", turns, r.wrist0->orientation_noise_rad, "mrad", 1e3,
                  "orientation_noise_rad: {:.2g}");
  }
  const auto em = [&](const char* name, const std::optional<EmStream>& stream) {
    if (!stream || !fast(stream->samples)) return;
    Components places, turns;
    for (const auto& s : stream->samples) {
      Push(places, s.value.p_RS);
      Push(turns, Turn(stream->samples.front().value.q_RS, s.value.q_RS));
    }
    check.Compare(name, "positions", places, stream->position_noise_m, "mm", 1e3,
                  "position_noise_m: {:.2g}");
    check.Compare(name, "orientations", turns, stream->orientation_noise_rad, "mrad", 1e3,
                  "orientation_noise_rad: {:.2g}");
  };
  em("em0", r.em0);
  em("em1", r.em1);
  if (r.strain0 && fast(r.strain0->moments_Nm)) {
    Components moments;
    for (const auto& s : r.strain0->moments_Nm) Push(moments, s.value);
    check.Compare("strain0", "moments", moments, r.strain0->moment_noise_Nm, "mNm", 1e3,
                  "moment_noise_Nm: {:.2g}");
  }
  if (r.load0 && fast(r.load0->f_tip_N)) {
    Components forces;
    for (const auto& s : r.load0->f_tip_N) Push(forces, s.value);
    // A load that is known, not measured, has none.
    const auto noise = NoiseOf(forces);
    if (noise && noise->most > 0.0)
      check.Compare("load0", "forces", forces, r.load0->force_noise_N, "mN", 1e3,
                    "force_noise_N: {:.2g}");
  }
  if (r.vision0 && fast(r.vision0->tips)) {
    Components places, directions;
    std::vector<double> variances;
    for (const auto& s : r.vision0->tips) {
      if (s.value.status != TipStatus::kOk) continue;
      Push(places, s.value.p_RE);
      variances.push_back(s.value.covariance_m2.trace() / 3.0);
      if (s.value.d_RE) Push(directions, *s.value.d_RE);
    }
    check.Compare("vision0", "positions", places, std::sqrt(std::max(0.0, Median(variances))), "mm",
                  1e3, "the covariance: a standard deviation of {:.2g} m an axis");
    if (directions.size() == 3 && directions.front().size() == places.front().size())
      check.Compare("vision0", "directions", directions,
                    r.vision0->direction_noise_rad * std::sqrt(2.0 / 3.0), "mrad", 1e3,
                    "direction_noise_rad: {:.2g}");
  }
  return check.findings;
}

}  // namespace flextip::plausibility
