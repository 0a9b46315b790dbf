// What a trial of the user study did in the forbidden region, and statistics over operators (5.3).
// Private to reproduction.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/mean_sd.h"

namespace flextip::reproduction {

/// The measures of 5.3, for tip positions at a constant rate and a wall at x = `wall_x_m` with the
/// forbidden region beyond it.
struct Incursion {
  double time_part = 0.0;        ///< share of the positions inside, 0 to 1
  double max_depth_m = 0.0;      ///< 0 where there was none
  double swept_area_m2 = 0.0;    ///< between the wall and pairs of following positions inside
  double outline_area_m2 = 0.0;  ///< the same without counting a place twice, in two planes, summed
};
/// Without `outline` the outline's area is left at zero: it takes longest.
Incursion MeasureIncursion(const std::vector<Eigen::Vector3d>& tips, double wall_x_m,
                           bool outline = true);

/// By the trapezoidal rule; distances along the wall in both directions.
double SweptArea(const std::vector<Eigen::Vector3d>& tips, double wall_x_m);
/// Union of the areas between wall and path inside, seen along axis `along` (1: y, 2: z).
double OutlineArea(const std::vector<Eigen::Vector3d>& tips, double wall_x_m, int along);

/// Two-sided p of Student's t-test that two independent samples with one variance have the same
/// mean. 1 where neither varies and the means are the same, 0 where neither varies and they are
/// not.
double StudentP(const MeanSd& a, const MeanSd& b);
/// The largest p over all pairs: "all differences significant at p <= ...".
double LargestP(const std::vector<MeanSd>& samples);

}  // namespace flextip::reproduction
