// Which effects are in all recordings, and which begin between two.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/several/joint_fit.h"

namespace flextip::diagnosis {

struct JointScored {
  JointWeighed weighed;
  double log_posterior = 0.0;  ///< evidence and prior odds, comparable between places
};

struct JointSelection {
  JointFit best;  ///< where the fleet stands
  /// What fits say of hypotheses, in log odds, less what the problem at the best place says.
  std::vector<std::pair<JointHypothesis, double>> corrections;
  int fits = 0;
  bool converged = false;
};

/// Hypotheses weighed where the fleet stands, best first: all of the catalogue in all recordings,
/// and changes of one effect beside the likeliest of these and beside `best`.
std::vector<JointScored> WeighAll(const JointEvidence& evidence, const Fleet& fleet,
                                  const JointHypothesis& best, const SelectionOptions& options);

/// Moves the fleet to the best place and leaves it there.
JointSelection SearchJointly(const MemberWorkers& workers);

}  // namespace flextip::diagnosis
