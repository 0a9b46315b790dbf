// The streams of a recording at common times. Sensors have their own rates: a lookup interpolates
// between the two samples around a time, and is empty outside the stream and across gaps longer
// than `max_gap_periods` of the sensor's nominal period (nothing is extrapolated or made up). At a
// sample's own time the sample itself is given, whatever the gaps beside it.
#pragma once

#include <optional>
#include <vector>

#include "recording/recording.h"

namespace flextip {

struct ResampleOptions {
  double max_gap_periods = 3.5;  ///< three lost samples in a row are bridged, with some jitter
};

/// Position linear, orientation along the shortest arc; no orientation where either neighbour has
/// none.
std::optional<WristSample> WristAt(const WristStream& stream, TimeNs t_ns,
                                   const ResampleOptions& options = {});

std::optional<EmSample> EmAt(const EmStream& stream, TimeNs t_ns,
                             const ResampleOptions& options = {});

std::optional<Eigen::Vector4d> StrainAt(const StrainStream& stream, TimeNs t_ns,
                                        const ResampleOptions& options = {});

std::optional<Eigen::Vector3d> LoadAt(const LoadStream& stream, TimeNs t_ns,
                                      const ResampleOptions& options = {});

/// What vision saw nearest to `t_ns`, within half its nominal period, with its own time stamp:
/// positions of different frames are not blended, since their covariance and status are their own.
std::optional<Sample<TipObservation>> TipAt(const VisionStream& stream, TimeNs t_ns);

/// The times of a series' samples.
template <class T>
std::vector<TimeNs> TimesOf(const Series<T>& series) {
  std::vector<TimeNs> times;
  times.reserve(series.size());
  for (const auto& sample : series) times.push_back(sample.t_ns);
  return times;
}

}  // namespace flextip
