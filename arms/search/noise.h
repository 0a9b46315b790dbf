// How much of each measurement is noise: as stated, and as what an answer leaves, with its memory.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "arms/replay/replay.h"

namespace flextip::arms {

/// Of one channel's components.
struct ChannelNoise {
  Eigen::VectorXd floor;   ///< as stated, or as neighbouring samples differ where none is
  Eigen::VectorXd sd;      ///< taken for one sample: what is left, times its memory
  Eigen::VectorXd memory;  ///< correlation of what is left from sample to sample
  Eigen::VectorXd left;    ///< root mean square of what is left
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> keep;  ///< measured, and no wild reading
};
using Noise = std::vector<ChannelNoise>;  ///< a channel of the replay each

/// Measures the noise from what the replay leaves; with `find_wild` leaves single readings out that
/// are far from all others.
Noise MeasureNoise(const Replay& replay, bool find_wild);

/// Rows that `noise` leaves out, of all channels.
long LeftOut(const Replay& replay, const Noise& noise);

}  // namespace flextip::arms
