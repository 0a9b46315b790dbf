// From the evidence of several recordings to probabilities: what all have in common, and what
// began.
#pragma once

#include <vector>

#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/several/joint_search.h"

namespace flextip::diagnosis {

/// A member's normal sums of its parameters, made one member after the other.
struct MemberSums {
  NormalSums narrow;             ///< generic terms within what a right form may miss
  std::vector<NormalSums> wide;  ///< generic terms that carry something unknown, by width
  std::vector<NormalSums> bags;  ///< of its blocks of time, drawn with replacement
  std::vector<NormalSums> wide_bags;
  double samples_as_one = 1.0;  ///< all of them are divided by it already
  double chi2_per_dof = 0.0;
};

/// `problem` of a member (by blocks of time); the bags differ by `seed`.
MemberSums SumsOf(const LinearProblem& problem, const Eigen::VectorXd& generic_sd, int bags,
                  std::uint64_t seed);

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
