// Work on one member by itself. Any process can do it that has read the recordings.
#pragma once

#include <variant>
#include <vector>

#include "diagnosis/several/fleet.h"
#include "diagnosis/several/judge_member.h"

namespace flextip::diagnosis {

/// To the base simulation: far samples left out, the noise model fixed, frequencies scanned, and
/// the generic basis and discrepancy taken there. Throws WorkError where the nominal instrument has
/// no equilibrium.
struct ToBase {
  bool scan_shared = false;  ///< what all share is scanned, too
  std::vector<double> scan_centres;
};

/// To a place, by the noise, forces' size and generic basis of before.
struct ToPlace {
  Place place;
};

/// Takes noise, unknown forces' size and generic basis anew at a place.
struct Remeasure {
  Place place;
};

/// Sums at a place, for probabilities.
struct SumUp {
  Place place;
  int bags = 0;
};

/// Gives the member's own answer at a place.
struct Judge {
  Place place;
  MemberContext context;
};

struct MemberTask {
  std::size_t member = 0;
  using What = std::variant<ToBase, ToPlace, Remeasure, SumUp, Judge>;
  What what;
};

/// Where a member stands, as the search needs it.
struct MemberState {
  Place place;
  NormalSums sums;
  int far_samples = 0;
};

struct NoEquilibrium {};

/// A state of the first three tasks. Of all but the first NoEquilibrium where the place has none.
using MemberAnswer = std::variant<NoEquilibrium, MemberState, MemberSums, JudgedMember>;

/// Does a task. The member keeps the noise, forces' size and generic basis that it took.
MemberAnswer DoTask(Fleet& fleet, const MemberTask& task, const DiagnoseOptions& options,
                    const SelectionOptions& selection_options);

}  // namespace flextip::diagnosis
