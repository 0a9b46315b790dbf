// Small hidden recordings for the tests of the diagnosis's parts.
#pragma once

#include "diagnosis/sample_set.h"
#include "simulation/hidden_recording.h"

namespace flextip {

/// Nothing but `effects` is off; sines for the motion, a varying load. Seeds are the test's own.
inline HiddenRecording SmallHidden(double duration_s, bool with_load, std::uint64_t seed,
                                   std::vector<std::string> effects = {}, bool noise_free = false) {
  HiddenOptions options{.effects = std::move(effects), .size = EffectSize::kStrong, .exact = true};
  options.with_load = with_load;
  options.noise_free = noise_free;
  options.scene.duration_s = duration_s;
  options.scene.motion = MotionKind::kSines;
  options.scene.load = LoadKind::kVarying;
  return MakeHidden(options, seed);
}

inline SampleSet SmallSamples(double duration_s, bool with_load, std::uint64_t seed,
                              std::vector<std::string> effects = {}, bool noise_free = false) {
  return MakeSampleSet(
      SmallHidden(duration_s, with_load, seed, std::move(effects), noise_free).recording, "small");
}

}  // namespace flextip
