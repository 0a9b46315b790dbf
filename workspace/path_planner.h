// The cheapest path in a plane where a metre's cost depends on place and direction.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

namespace flextip {

/// Cost of a metre at p along the unit vector v: positive, infinite where no path may go. Called
/// from several threads.
using PathCost = std::function<double(const Eigen::Vector2d& p, const Eigen::Vector2d& v)>;

struct PathProblem {
  Eigen::Vector2d start, goal;
  Eigen::Vector2d low, high;  ///< corners of the searched region, which holds start and goal
  double spacing_m = 0.005;   ///< spacing of the search grid
};

enum class PathStatus {
  kOk,
  kStartOrGoalOutside,  ///< one of them is where no path may go, or not in the region
  kNoPath,              ///< nothing joins them
};
const char* Name(PathStatus status);

struct Path {
  PathStatus status = PathStatus::kNoPath;
  std::vector<Eigen::Vector2d> points = {};  ///< from start to goal
  double length_m = 0.0, cost = 0.0;
};

/// Returns the integral of the cost along the path's straight pieces, sampled at most `spacing_m`
/// apart.
double CostAlong(const PathCost& cost, const std::vector<Eigen::Vector2d>& points,
                 double spacing_m);
double LengthOf(const std::vector<Eigen::Vector2d>& points);
/// Returns the same path with points at most `spacing_m` apart.
std::vector<Eigen::Vector2d> Resample(const std::vector<Eigen::Vector2d>& points, double spacing_m);

/// Plans by Dijkstra on a grid with 32 directions, then by shortcuts, then by moving every point to
/// the cheapest place. The grid chooses among paths around obstacles; the other steps make the path
/// smooth. Uses all cores.
Path PlanPath(const PathCost& cost, const PathProblem& problem);

}  // namespace flextip
