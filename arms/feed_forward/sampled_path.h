// A path of joints that is given by rows: joints and rates at any time, and the commands that bring
// an arm along it.
#pragma once

#include <Eigen/Dense>

#include "arms/data/arm_data.h"
#include "control/joints/joint_feed_forward.h"

namespace flextip::arms {

/// Looking at it allocates nothing.
class SampledPath {
 public:
  /// Throws InputError for fewer than five rows, times that do not ascend, or numbers that are not
  /// finite.
  explicit SampledPath(Track rows);

  const Track& Rows() const { return rows_; }
  /// Joints at a time, smooth between the rows; at rest before the first and after the last.
  JointVector JointsAt(double t_s) const;
  JointVector RatesAt(double t_s) const;
  /// What a feed-forward wants to know at `t_s`: the path by its lead later.
  JointWish WishAt(double t_s, const JointFeedForward& feed_forward) const;

 private:
  JointVector Between(const Eigen::MatrixXd& values, double t_s) const;
  bool IsWithin(double t_s) const;

  Track rows_;
  Eigen::MatrixXd slopes_, rates_, accelerations_;
};

/// Commands for a path, at its rows, and how many of them were limited or within a play.
struct PathCommands {
  Eigen::MatrixXd q;
  int rate_limited = 0, correction_limited = 0, taking_up = 0;
};
PathCommands CommandsFor(const SampledPath& path, const JointModel& model,
                         const FeedForwardOptions& options = {});

}  // namespace flextip::arms
