#include "bench/clocks/session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "testdata/hidden/recording.h"

namespace flextip::bench {
namespace {

using Rng = std::mt19937_64;

/// What delays the shaft behind the wrist, bends it, or moves it on its own.
const std::vector<std::string>& Effects() {
  static const std::vector<std::string> names{
      "port_friction",   "backlash",       "port_motion",    "stiffness",   "wrist_compliance",
      "port_compliance", "tip_compliance", "shaft_load",     "port_moment", "precurvature",
      "port_grip",       "shaft_tissue",   "second_contact", "em_latency",  "em_distortion"};
  return names;
}

/// The stream's stamps by its own clock.
template <class T>
void Restamp(Series<T>& samples, const TrueClock& clock) {
  for (auto& sample : samples) {
    const double since_s = 1e-9 * static_cast<double>(sample.t_ns - clock.origin_ns);
    const double own_s = (since_s - clock.offset_s) / (1.0 + clock.rate);
    sample.t_ns = clock.origin_ns + std::llround(1e9 * own_s);
  }
}

}  // namespace

ClockSession DrawSession(const SessionKind& kind, std::uint64_t seed) {
  Rng rng(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  hidden::HiddenOptions options;
  options.scene.family = hidden::MotionFamily::kAny;
  options.scene.duration_s = kind.fast ? 30.0 : 24.0;
  if (kind.fast) options.scene.motion = hidden::MotionKind::kShake;
  options.tick_rate_hz = 100.0;
  options.links_per_side = 30;
  options.with_load = seed % 2 == 0;
  if (kind.effects) {
    std::vector<std::string> names = Effects();
    std::shuffle(names.begin(), names.end(), rng);
    options.effects = {names[0], names[1]};
  }
  hidden::HiddenRecording hidden = hidden::MakeHidden(options, seed);
  ClockSession session;
  session.recording = std::move(hidden.recording);
  session.name = fmt::format("seed {}, {}, load {}, {}", seed, Name(hidden.scene.motion_setup.kind),
                             Name(hidden.scene.load.kind), fmt::join(hidden.label.present, " "));
  const auto draw = [&](const std::string& stream, auto& samples) {
    TrueClock clock{2.5 * unit(rng), 1e-4 * unit(rng), session.recording.wrist0->samples[0].t_ns};
    Restamp(samples, clock);
    session.clocks[stream] = clock;
  };
  Recording& r = session.recording;
  if (r.em0) draw("em0", r.em0->samples);
  if (r.vision0) draw("vision0", r.vision0->tips);
  if (r.strain0) draw("strain0", r.strain0->moments_Nm);
  if (r.load0) draw("load0", r.load0->f_tip_N);
  const auto late = [&](const char* effect) {
    return hidden.label.parameters.at(effect).at("delay_s")[0];
  };
  if (r.em0) session.clocks["em0"].offset_s -= late("em_latency");
  if (r.vision0) session.clocks["vision0"].offset_s -= late("camera_latency");
  return session;
}

}  // namespace flextip::bench
