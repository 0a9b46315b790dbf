// Recordings whose effect is hidden: everything is drawn from a seed, the plant runs open loop
// along a wrist motion, the sensors sample it, and the label goes to the caller alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "recording/truth.h"
#include "testdata/hidden/carrier.h"
#include "testdata/hidden/draw.h"
#include "testdata/hidden/scene.h"

namespace flextip::hidden {

struct HiddenOptions {
  /// Of the catalogue or not; InputError for an unknown name.
  std::vector<std::string> effects = {};
  int drawn_effects = 0;  ///< so many more from the catalogue, of the sensors present
  EffectSize size = EffectSize::kPlain;
  bool exact = false;     ///< nothing else is off
  bool with_load = true;  ///< load0 is recorded
  /// em0, strain0, vision0 (then also cam0), wrist0_orientation.
  std::vector<std::string> left_out = {};
  SceneDraw scene = {};            ///< motion, load, duration
  double noise_scale = 1.0;        ///< true noise over the stated noise
  double noise_correlation = 0.0;  ///< AR(1) coefficient from sample to sample
  bool noise_free = false;         ///< stated all the same
  double tick_rate_hz = 100.0;     ///< rate of the plant: a multiple of 50
  int links_per_side = 60;         ///< links of the plant's chain, before and behind the port
  Carrier* carrier = nullptr;      ///< carries the wrist of MakeHidden's; null: exactly
};

struct HiddenRecording {
  Recording recording;
  Series<TruthSample> truth;
  HiddenLabel label;
  HiddenScene scene;
  int attempt = 0;  ///< draws that had no equilibrium before this one
};

/// The same options and seed give the same recording; scene, other parameters and noise stay the
/// same when only effects, size or sensors change (as long as no draw has to be repeated). Throws
/// InputError for options that make no sense, WorkError where 20 draws have no equilibrium.
HiddenRecording MakeHidden(const HiddenOptions& options, std::uint64_t seed);

/// Recordings of one instrument in one room, one after the other.
struct HiddenSeries {
  HiddenOptions options = {};  ///< of the first, as MakeHidden takes them
  int recordings = 3;
  std::vector<std::string> later = {};  ///< effects that begin
  int begin = 1;                        ///< with this recording, counted from zero; at least 1
};

/// The first is MakeHidden's. The others have its instrument, room, effects, tolerances and stated
/// noise; motion, load, roll and the phases of breath and interference are their own. Throws as
/// MakeHidden.
std::vector<HiddenRecording> MakeHiddenSeries(const HiddenSeries& series, std::uint64_t seed);

/// Writes the folder, which must not exist or be empty: the recording, without its label, and
/// without truth0 unless asked for.
void WriteHidden(const std::filesystem::path& folder, const HiddenRecording& hidden,
                 bool with_truth = false);

}  // namespace flextip::hidden
