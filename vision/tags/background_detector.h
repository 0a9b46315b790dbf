// Full tag detection on a thread of its own, so that a lost tip does not stall the tracking.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/time_series.h"
#include "vision/tags/detector.h"

namespace flextip {

class BackgroundDetector {
 public:
  explicit BackgroundDetector(const TagDetectorOptions& options);
  ~BackgroundDetector();
  BackgroundDetector(BackgroundDetector&&) noexcept;
  BackgroundDetector& operator=(BackgroundDetector&&) noexcept;

  /// Copies the picture and starts the search in it. Returns false, and does nothing, while an
  /// earlier picture is still searched.
  bool Submit(const Image& image, TimeNs t_ns);

  struct Found {
    TimeNs t_ns = 0;  ///< of the picture
    std::vector<TagDetection> tags;
  };
  /// Returns the tags of the last picture that was searched, once; empty where there is none since.
  std::optional<Found> Take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
