// From the evidence of several recordings to probabilities: what all have in common, and what
// began.
#pragma once

#include <vector>

#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/several/joint_search.h"
#include "diagnosis/several/judge_member.h"

namespace flextip::diagnosis {

struct ProbableChange {
  Change change;
  double probability = 0.0;  ///< that the effect begins, and begins there
};

struct JointProbabilities {
  Probabilities common;                 ///< of what is in all recordings
  std::vector<ProbableChange> changes;  ///< that are likelier than not, by recording
  JointWeighed answer;                  ///< both together
};

JointProbabilities MakeJointProbabilities(const Fleet& fleet, const std::vector<MemberSums>& sums,
                                          const JointSelection& selection,
                                          const SelectionOptions& options);

}  // namespace flextip::diagnosis
