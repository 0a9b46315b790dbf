// Single readings that stand apart from those around them: a glint taken for a tag, a lost bit.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip::diagnosis {

/// Which of `readings` (one a row, in order of time) stand apart: some column is further from the
/// median of the three readings on either side, once those are freed of their trend, than eight
/// standard deviations. That is the largest of `noise` (by column), what the window shows and what
/// the whole series shows, by medians of absolute deviations (Hampel's filter). Steps and lasting
/// changes are not apart, nor are the first three and last three.
std::vector<bool> StandApart(const Eigen::MatrixXd& readings, const Eigen::VectorXd& noise);

/// `recording` without such readings of its sensors, wrist and load, and a warning for each stream
/// that had some. Streams whose samples are too far apart to follow the motion stay as they are.
Recording WithoutOutliers(Recording recording, std::vector<std::string>& warnings);

}  // namespace flextip::diagnosis
