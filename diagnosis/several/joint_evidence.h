// How well a hypothesis explains several recordings together: evidence by Gaussian integrals over
// what all share and what is each one's own.
#pragma once

#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "diagnosis/several/fleet.h"
#include "diagnosis/several/reduced_sums.h"

namespace flextip::diagnosis {

/// An effect that is present from the recording `first` on (counted from zero), not before.
struct Change {
  int effect = 0, first = 0;
  bool operator==(const Change&) const = default;
};

/// Effects that are present in all recordings, and those that begin between two.
struct JointHypothesis {
  std::vector<int> effects;
  std::vector<Change> changes;
  bool unknown = false;  ///< something is there that the catalogue does not hold
  bool operator==(const JointHypothesis&) const = default;

  /// The effects that are present in recording `r`.
  std::vector<int> EffectsIn(std::size_t r) const;
};

struct JointWeighed {
  JointHypothesis hypothesis;
  double log_evidence = 0.0;   ///< absolute: comparable between places
  std::vector<double> scales;  ///< widths that explain best: of the effects, then of the changes
};

class JointEvidence {
 public:
  /// `sums` of each member, of its layout's parameters.
  JointEvidence(const Fleet& fleet, std::vector<NormalSums> sums);

  JointWeighed Weigh(const JointHypothesis& hypothesis) const;

  /// `weighed` with each shared effect in turn beginning in each recording but the first: what is
  /// added to its evidence, as of its best widths.
  struct AddedChange {
    Change change;
    double log_gain = 0.0;
  };
  std::vector<AddedChange> WithChanges(const JointWeighed& weighed) const;

  /// The most likely parameters of each member under `weighed`.
  std::vector<Eigen::VectorXd> Mode(const JointWeighed& weighed) const;
  /// Minus twice the log of how likely these are, comparable between places.
  double Merit(const JointWeighed& weighed, const std::vector<Eigen::VectorXd>& theta) const;
  /// What all members but `r` say of the parameters of `r`, where they are the same there.
  NormalSums KnownTo(std::size_t r, const JointWeighed& weighed) const;

 private:
  /// Effects with own parameters that are wide, each with its scale, in order.
  using Wide = std::vector<std::pair<int, double>>;
  struct Joint {
    NormalSums sums;  ///< the shared parameters, then each change's
    Eigen::VectorXd sd;
    std::vector<int> positive;
  };

  Wide WideIn(std::size_t r, const JointWeighed& weighed) const;
  std::vector<int> Out(const Member& member) const;
  Eigen::VectorXd OutSd(const Member& member, const Wide& wide) const;
  NormalSums Reduced(std::size_t r, const Wide& wide) const;
  /// Sums over the first 0, 1, 2 ... members.
  const std::vector<NormalSums>& Cumulated(const Wide& wide) const;
  NormalSums Range(const Wide& wide, std::size_t begin, std::size_t end) const;
  /// Sums over the members from `begin` on, each with what is wide in it.
  NormalSums From(std::size_t begin, const JointWeighed& weighed) const;
  Joint Assemble(const JointWeighed& weighed) const;
  double LogEvidence(const Joint& joint) const;

  const Fleet& fleet_;
  std::vector<NormalSums> sums_;
  mutable std::mutex mutex_;
  mutable std::map<Wide, std::vector<NormalSums>> cumulated_;
};

}  // namespace flextip::diagnosis
