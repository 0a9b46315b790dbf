// Small hidden recordings for the tests of the diagnosis's parts.
#pragma once

#include "diagnosis/samples/sample_set.h"
#include "testdata/hidden/recording.h"

namespace flextip::diagnosis {

/// Nothing but `effects` is off; sines for the motion, a varying load. Seeds are the test's own.
inline hidden::HiddenRecording SmallHidden(double duration_s, bool with_load, std::uint64_t seed,
                                           std::vector<std::string> effects = {},
                                           bool noise_free = false) {
  hidden::HiddenOptions options{
      .effects = std::move(effects), .size = hidden::EffectSize::kStrong, .exact = true};
  options.with_load = with_load;
  options.noise_free = noise_free;
  options.scene.duration_s = duration_s;
  options.scene.motion = hidden::MotionKind::kSines;
  options.scene.load = hidden::LoadKind::kVarying;
  return hidden::MakeHidden(options, seed);
}

inline SampleSet SmallSamples(double duration_s, bool with_load, std::uint64_t seed,
                              std::vector<std::string> effects = {}, bool noise_free = false) {
  return MakeSampleSet(
      SmallHidden(duration_s, with_load, seed, std::move(effects), noise_free).recording, "small");
}

}  // namespace flextip::diagnosis
