// Full tag detection beside the tracking, so that a lost tip stalls nothing.
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

  /// False, and nothing done, while an earlier picture is still searched. The picture is copied.
  bool Submit(const Image& image, TimeNs t_ns);

  struct Found {
    TimeNs t_ns = 0;  ///< of the picture
    std::vector<TagDetection> tags;
  };
  /// What was found since, once.
  std::optional<Found> Take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
