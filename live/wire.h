// Messages between flextip and its peers (robots, trackers, viewers), whatever protocol carries
// them.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/time_series.h"

namespace flextip::live {

/// A pose. Trackers of five degrees of freedom or fewer know no full orientation: R is then what
/// they sent where that is a rotation, otherwise the identity.
struct WireTransform {
  Pose T_RD;  ///< device D in the peer's frame R (m)
  bool has_orientation = true;
};

struct WireNumbers {
  std::vector<double> values;  ///< as on the wire: units are the stream's
};

struct WireText {
  std::string text;
};

struct WireImage {
  Image image;
};

/// A line through places in R (m).
struct WireLine {
  std::vector<Eigen::Vector3d> points;
};

/// A message of a peer, in metres; codecs alone know millimetres.
struct WireMessage {
  std::string device;
  TimeNs t_ns = 0;  ///< the header's stamp, from 1970; 0: the peer says the data are invalid
  std::variant<WireTransform, WireNumbers, WireText, WireImage, WireLine> body;
};

/// What befell a connection; `what` names peer and cause in one line.
struct WireEvent {
  enum class Kind : std::uint8_t { kConnected, kLost, kRefused };
  Kind kind = Kind::kConnected;
  std::string what;
  std::string device = {};  ///< that it befell; empty: all of the peer's
};

/// How many messages a connection, or several, took and why others went no further.
struct WireCounts {
  std::int64_t passed = 0;        ///< given on
  std::int64_t repeated = 0;      ///< of the time of the device's last message
  std::int64_t out_of_order = 0;  ///< older than the device's last message
  std::int64_t refused = 0;       ///< damaged, or of impossible content
  std::int64_t ignored = 0;       ///< of a type without use here
  std::int64_t unsent = 0;        ///< not sent: the peer was gone or did not read
};

}  // namespace flextip::live
