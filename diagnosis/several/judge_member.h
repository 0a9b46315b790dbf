// A member at the best place of all: its sums for probabilities, and its own answer in the light of
// the others.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/heldout.h"
#include "diagnosis/several/fleet.h"

namespace flextip::diagnosis {

/// Standard deviations, in noise sd, of generic terms that carry something unknown.
inline constexpr std::array kUnknownWidths{0.1, 0.3, 1.0, 3.0};

/// A member's normal sums of its parameters, made one member after the other.
struct MemberSums {
  NormalSums narrow;             ///< generic terms within what a right form may miss
  std::vector<NormalSums> wide;  ///< generic terms that carry something unknown, by width
  std::vector<NormalSums> bags;  ///< of its blocks of time, drawn with replacement
  std::vector<NormalSums> wide_bags;
  double samples_as_one = 1.0;  ///< all of them are divided by it already
  double chi2_per_dof = 0.0;
};

/// The bags differ by `seed`. Empty: no equilibrium at `place`.
std::optional<MemberSums> SumMember(Member& member, const Place& place, int bags,
                                    std::uint64_t seed, const SelectionOptions& options);

/// What is known of all members, to judge one of them.
struct MemberContext {
  NormalSums known;            ///< what the others say of the member's parameters
  std::vector<int> present;    ///< effects of the answer that are in this member
  std::vector<int> common;     ///< effects of the answer that are in all
  bool names_effects = false;  ///< the answer on what is in all does
  bool converged = false;
  int fits = 0;
  int bags = 0;
  TimeNs start_ns = 0;  ///< of the recording
  bool is_first = false, is_last = false;
};

struct JudgedMember {
  DiagnosisResult own;
  HeldOut heldout;
  // Of what is in all, where the member is the first.
  std::vector<EffectFit> common_parameters, common_within_tolerance;
  Eigen::MatrixXd common_covariance;
  SensorTolerance common_sensor_tolerance;
  std::vector<std::vector<std::string>> common_groups;
  std::string separating_motion;
  double separating_score = 0.0;
};

/// Empty: no equilibrium at `place`.
std::optional<JudgedMember> JudgeMember(Member& member, const Place& place,
                                        const MemberContext& context,
                                        const DiagnoseOptions& options,
                                        const SelectionOptions& selection_options);

}  // namespace flextip::diagnosis
