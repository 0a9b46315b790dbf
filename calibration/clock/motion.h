// The motion that a stream saw, as numbers over time: what clocks are compared by.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip {

/// The straight shaft of a wrist's motion.
struct WristPort {
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();
  double length_m = 0.0;
};

/// Samples of a quantity that moves. Times are seconds since a time common to all streams.
struct Motion {
  std::string stream = {};    ///< "em0"
  std::string quantity = {};  ///< "sensor position", for messages and pages
  std::vector<double> t_s = {};
  Eigen::MatrixXd values = {};  ///< a column a sample
  bool is_force = false;        ///< force or moment, which motion alone does not tell
  int own_rows = 3;  ///< the first rows are the quantity; further rows help to predict others by it
  /// A sample's values are multiplied by its matrix to have noise 1; empty: all noise is alike.
  std::vector<Eigen::Matrix3d> whitening = {};
  std::optional<WristPort> port = {};  ///< of a wrist: its position is the last three rows

  std::size_t Count() const { return t_s.size(); }
  /// Returns the median time between samples; 0 with less than two.
  double PeriodSeconds() const;
};

struct Motions {
  TimeNs epoch_ns = 0;  ///< t_s = 0
  std::vector<Motion> streams;

  const Motion* Find(const std::string& stream) const;
  /// Returns "wrist0, em0".
  std::string Names() const;
};

/// Returns the motions of a recording's streams that have any, the best reference first: wrist0
/// (tip of the straight shaft through the port, and wrist), em0 (sensor, and its axes), vision0
/// (tip as seen, its `ok` frames), load0 (force), strain0 (moments).
Motions MotionsOf(const Recording& recording);

}  // namespace flextip
