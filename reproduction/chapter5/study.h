// The user study: groups of trials, all operators each. Private to reproduction.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "reproduction/chapter5/statistics.h"
#include "reproduction/chapter5/trial.h"

namespace flextip::reproduction {

/// One condition of the study: all operators do it.
struct StudyGroup {
  std::string name;
  TrialSetup setup;
  int operators = 10;
  int position = -1;  ///< place in the order of the thesis's four controllers; -1: none, done last
  bool keep_paths = false;
  bool outline = false;  ///< also the areas, which take time
};

struct OperatorResult {
  Incursion recorded, truth;
  double max_flexion_m = 0.0, rms_flexion_m = 0.0;
  double rms_side_force_N = 0.0, max_side_force_N = 0.0, max_push_N = 0.0;
  double cut_part = 0.0, straight_part = 0.0, no_tip_part = 0.0;
  double worst_m = 0.0;  ///< the deepest true x less the wall's, below zero where there was none
  bool lost = false;
  double rate_hz = 0.0;
  std::vector<Eigen::Vector3d> recorded_path;  ///< only where the options keep paths
};

struct GroupResult {
  StudyGroup group;
  std::vector<OperatorResult> operators;

  /// Over the operators.
  MeanSd Of(const std::function<double(const OperatorResult&)>& value) const;
};

/// Runs all trials on all cores. Operators differ by `seed` and their number alone, whatever groups
/// there are. `progress` is called by one thread at a time.
std::vector<GroupResult> RunStudy(const std::vector<StudyGroup>& groups, std::uint64_t seed,
                                  const std::function<void(double done)>& progress);

/// Which place in an operator's order the thesis's controller `condition` (0 to 3) has: a balanced
/// Latin square, in which each follows each other equally often.
int PlaceInOrder(int operator_number, int condition);

}  // namespace flextip::reproduction
