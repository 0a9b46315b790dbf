// The clocks of a recording's streams against one of them, from the motion that the streams share.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/clock/lag_search.h"
#include "recording/calibrations/file.h"
#include "recording/recording.h"

namespace flextip {

struct ClockOptions {
  std::string reference = {};  ///< the stream whose clock holds; empty: the first that moves of
                               ///< wrist0, em0, vision0, load0, strain0
  double most_offset_s = 10.0;
  double least_overlap_s = 4.0;
};

enum class ClockStatus : std::uint8_t {
  kOk,
  kTooShort,        ///< hardly any time in common within the offsets asked for
  kNoSharedMotion,  ///< no offset predicts the stream better than any other
  kAmbiguous,       ///< another offset predicts it as well: the motion repeats itself
  kNotConverged,
};

/// Returns "ok", "too short", "no shared motion", "ambiguous" or "not converged".
const char* Name(ClockStatus status);

/// One stream's clock. The reference's time for the stream's time t is
/// t + offset_s + rate (t - origin), all in seconds.
struct StreamClock {
  std::string stream = {}, reference = {};
  std::string by = {};  ///< the stream it was compared with, where that is not the reference
  ClockStatus status = ClockStatus::kNoSharedMotion;
  std::string reason = {};  ///< one line, where the status is not kOk
  double offset_s = 0.0, rate = 0.0;
  TimeNs origin_ns = 0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset (s) and rate
  double misfit = 1.0;  ///< residual over variance of the stream's values, after the alignment
  std::size_t samples = 0;
  MisfitProfile profile = {};  ///< against offsets from -most to most, for the page

  bool IsUsable() const { return status == ClockStatus::kOk; }
};

struct ClockResult {
  std::string reference;
  std::vector<StreamClock> streams = {};  ///< all others that the recording has
};

/// Compares every stream with the reference: likely offsets by the correlation of speeds, then
/// offset, rate and a linear prediction by Gauss-Newton. A stream without shared motion is compared
/// with those already aligned. Throws InputError where the reference is absent, and where there are
/// less than two streams.
ClockResult AlignClocks(const Recording& recording, const ClockOptions& options = {});

/// Returns `STREAM.time_offset_s`, `STREAM.time_rate` and `STREAM.time_origin_s` of all streams
/// that were aligned, with covariance, and the others as unobservable. vision0 counts as the clock
/// of its camera.
Calibration ClockEntries(const ClockResult& result, const std::string& camera = "cam0");

}  // namespace flextip
