// A sample of a stream as a cycle is given it.
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "core/time_series.h"
#include "core/tip_observation.h"
#include "live/session/session.h"
#include "live/wire.h"
#include "recording/recording.h"

namespace flextip::live {

/// Returns a value of a stream that means nothing, but has no rest of memory in it.
template <class T>
T EmptyValue() {
  if constexpr (std::is_same_v<T, Eigen::Vector3d> || std::is_same_v<T, Eigen::Vector4d>) {
    return T::Zero();
  } else {
    return T{};
  }
}

/// A sample, the time it was taken (latency taken off) and the time it arrived (1970).
template <class T>
struct Arrived {
  TimeNs t_ns = 0, arrived_ns = 0;
  T value = EmptyValue<T>();
};

/// The tip by vision with the noise of its direction (rad, per axis across it).
struct SeenTip {
  TipObservation tip;
  double direction_noise_rad = 0.0;
};

/// Where the tip is to go (m, in R), as a peer says.
struct GoalSample {
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
};

/// A sample of any stream.
using AnySample = std::variant<WristSample, SeenTip, EmSample, Eigen::Vector4d, Eigen::Vector3d>;

/// Returns the sample in a message of `stream`, in SI units. Empty, with the values found in `why`,
/// where the body is of another kind or size, not finite, or in another unit: no wrist is 600 m
/// away.
std::optional<AnySample> SampleIn(StreamName stream, const WireMessage& message, std::string& why);

}  // namespace flextip::live
