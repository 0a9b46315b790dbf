// The full fit of one hypothesis to several recordings together.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/several/joint_evidence.h"
#include "diagnosis/several/workers.h"

namespace flextip::diagnosis {

/// Where all members stand, to come back to without solving anything.
struct JointPlace {
  std::vector<Place> places;
  std::vector<NormalSums> sums;
  std::vector<Eigen::VectorXd> theta;
};
JointPlace PlaceOf(const Fleet& fleet);
void GoTo(Fleet& fleet, const JointPlace& place);

/// Puts all members at the base simulation (member_work.h), what all share about the same centre.
void StandAtBase(const MemberWorkers& workers);

/// Takes noise, unknown forces' size and generic basis anew where the members stand.
void FixMeasure(const MemberWorkers& workers);

/// Weighed where the fleet stands.
JointEvidence EvidenceHere(const Fleet& fleet);

struct JointFit {
  JointWeighed weighed;
  double log_posterior = -1e300;
  double promised = 0.0;  ///< in log odds, between where the fit stopped and its target
  JointPlace place;
};

/// log of the prior odds: those of a single recording's hypothesis, and of each change.
double LogPrior(const JointHypothesis& h, const Fleet& fleet, const SelectionOptions& options);

/// From where the fleet stands, at most `rounds` steps, until less than `rest` log odds are
/// promised; given up after two where the log posterior is clearly below `worth`, and after one
/// where it is far below.
JointFit FitJointly(const MemberWorkers& workers, const JointHypothesis& hypothesis, int rounds,
                    double worth, double rest);

}  // namespace flextip::diagnosis
