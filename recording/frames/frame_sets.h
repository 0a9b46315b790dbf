// The frames of several cameras, those taken at the same time together.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/time_series.h"
#include "recording/frames/frame_source.h"

namespace flextip {

struct FrameSet {
  TimeNs t_ns = 0;
  std::vector<std::optional<Image>> images;  ///< one a camera

  std::vector<const Image*> Pointers() const;
};

/// Which frame of each of two cameras belongs to a time; absent: that camera has none.
struct FramePair {
  TimeNs t_ns = 0;  ///< the first camera's, where it has a frame
  bool first = false, second = false;
};

/// Every time stamp of both (each in rising order) once: two that are at most `tolerance_ns` apart,
/// with none nearer to either, make one pair.
std::vector<FramePair> PairFrames(const std::vector<TimeNs>& first,
                                  const std::vector<TimeNs>& second, TimeNs tolerance_ns);

/// One source as it is, or two by their pairs. One set is held at a time.
class FrameSets {
 public:
  explicit FrameSets(std::unique_ptr<FrameSource> only);
  /// `pairs` as PairFrames makes them of all that the sources hold.
  FrameSets(std::unique_ptr<FrameSource> first, std::unique_ptr<FrameSource> second,
            std::vector<FramePair> pairs);

  std::size_t Cameras() const { return sources_.size(); }
  std::size_t Count() const;  ///< 0: not known
  void Skip(std::size_t sets);
  /// Empty after the last. A video that ends early leaves the other camera's frames alone.
  std::optional<FrameSet> Next();

 private:
  std::vector<std::unique_ptr<FrameSource>> sources_;
  std::vector<FramePair> pairs_;  // of two sources
  std::size_t next_ = 0;
};

}  // namespace flextip
