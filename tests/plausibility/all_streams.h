// Recordings with all streams, for tests that break them.
#pragma once

#include "recording/recording.h"
#include "testdata/broken/broken_recording.h"
#include "testdata/hidden/recording.h"

namespace flextip {

/// Returns a healthy recording of 14 s with the motion and load of `scene`, and all streams.
inline Recording WithAllStreams(hidden::SceneDraw scene, std::uint64_t seed) {
  hidden::HiddenOptions options;
  options.scene = std::move(scene);
  options.scene.duration_s = 14.0;
  options.tick_rate_hz = 50.0;
  options.links_per_side = 30;
  Recording recording = hidden::MakeHidden(options, seed).recording;
  broken::Rng rng(seed);
  broken::AddFurtherStreams(recording, rng);
  return recording;
}

}  // namespace flextip
