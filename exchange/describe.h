// The streams of a recording, a line each.
#pragma once

#include <string>
#include <vector>

#include "core/time_series.h"
#include "recording/recording.h"

namespace flextip::exchange {

struct StreamLine {
  std::string name;
  std::size_t samples = 0;
  TimeNs first_ns = 0, last_ns = 0;
  double rate_hz = 0.0;
  std::string first_value;

  double Seconds() const { return 1e-9 * static_cast<double>(last_ns - first_ns); }
};

/// Of every stream with samples.
std::vector<StreamLine> DescribeStreams(const Recording& recording);

/// "12.3, 4, 5": six digits each.
std::string VectorText(const Eigen::VectorXd& v);

}  // namespace flextip::exchange
