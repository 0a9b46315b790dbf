// The tracker's call with a prediction from outside, where the tracker takes one.
#pragma once

#include <optional>

#include "vision/tip_tracker.h"
#if __has_include("vision/tip_prediction.h")
#include "vision/tip_prediction.h"
#else
namespace flextip {
struct TipPrediction {
  Pose T_RE;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};
}  // namespace flextip
#endif

namespace flextip {

template <class Tracker>
constexpr bool kTakesPrediction = requires(Tracker& tracker, const Image& image,
                                           const std::optional<TipPrediction>& prediction) {
  tracker.Track(image, TimeNs{}, prediction);
};

template <class Tracker>
TipTrack TrackFrame(Tracker& tracker, const Image& image, TimeNs t_ns,
                    const std::optional<TipPrediction>& prediction) {
  if constexpr (kTakesPrediction<Tracker>) {
    return tracker.Track(image, t_ns, prediction);
  } else {
    return tracker.Track(image, t_ns);
  }
}

}  // namespace flextip
