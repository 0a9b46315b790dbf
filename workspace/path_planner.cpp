#include "workspace/path_planner.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <cmath>
#include <limits>
#include <numeric>

namespace flextip {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Simpson's rule on pieces at most two spacings long.
double SegmentCost(const PathCost& cost, const Vector2d& a, const Vector2d& b, double spacing_m) {
  const double length = (b - a).norm();
  if (length == 0.0) return 0.0;
  const Vector2d v = (b - a) / length;
  const int pieces = std::max(1, int(std::ceil(length / (2.0 * spacing_m) - 1e-9)));
  double sum = 0.0;
  for (int i = 0; i <= 2 * pieces; ++i) {
    const double weight = i == 0 || i == 2 * pieces ? 1.0 : i % 2 ? 4.0 : 2.0;
    sum += weight * cost(a + (0.5 * i / pieces) * (b - a), v);
    if (sum == kInf) return kInf;
  }
  return sum * length / (6.0 * pieces);
}

/// One of two opposite moves for each direction: (column, row) in grid steps without a common
/// factor.
std::vector<std::pair<int, int>> Moves() {
  std::vector<std::pair<int, int>> moves;
  for (int r = -3; r <= 3; ++r)
    for (int c = -3; c <= 3; ++c)
      if (std::gcd(std::abs(r), std::abs(c)) == 1) moves.emplace_back(c, r);
  return moves;
}

/// A grid over the region with the start on one of its nodes.
class Grid {
 public:
  explicit Grid(const PathProblem& problem) : start_(problem.start), spacing_(problem.spacing_m) {
    const Vector2d below = (problem.start - problem.low) / spacing_;
    const Vector2d above = (problem.high - problem.start) / spacing_;
    first_column_ = int(std::floor(below.x()));
    first_row_ = int(std::floor(below.y()));
    columns_ = first_column_ + int(std::floor(above.x())) + 1;
    rows_ = first_row_ + int(std::floor(above.y())) + 1;
  }

  int Rows() const { return rows_; }
  int Columns() const { return columns_; }
  std::size_t Node(int column, int row) const { return std::size_t(row) * columns_ + column; }
  std::size_t Nodes() const { return std::size_t(rows_) * columns_; }
  std::size_t StartNode() const { return Node(first_column_, first_row_); }
  Vector2d At(std::size_t node) const {
    const int row = int(node) / columns_, column = int(node) % columns_;
    return start_ + spacing_ * Vector2d(column - first_column_, row - first_row_);
  }
  bool Has(int column, int row) const {
    return column >= 0 && column < columns_ && row >= 0 && row < rows_;
  }

 private:
  Vector2d start_;
  double spacing_;
  int first_column_ = 0, first_row_ = 0, columns_ = 0, rows_ = 0;
};

using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property,
                                    boost::property<boost::edge_weight_t, double>>;

/// The grid's moves with their costs, and the last stretches to the goal, which is one node more.
Graph MakeGraph(const PathCost& cost, const PathProblem& problem, const Grid& grid) {
  struct Edge {
    std::size_t from, to;
    double cost;
  };
  const auto moves = Moves();
  std::vector<std::vector<Edge>> by_row(std::size_t(grid.Rows()));
  tbb::parallel_for(0, grid.Rows(), [&](int row) {
    for (int column = 0; column < grid.Columns(); ++column) {
      const std::size_t from = grid.Node(column, row);
      const Vector2d p = grid.At(from);
      const auto add = [&](std::size_t to, const Vector2d& q) {
        const double edge = SegmentCost(cost, p, q, problem.spacing_m);
        if (edge < kInf) by_row[std::size_t(row)].push_back({from, to, edge});
      };
      for (const auto& [c, r] : moves) {
        if (!grid.Has(column + c, row + r)) continue;
        const std::size_t to = grid.Node(column + c, row + r);
        add(to, grid.At(to));
      }
      if ((p - problem.goal).norm() < 2.0 * problem.spacing_m) add(grid.Nodes(), problem.goal);
    }
  });
  Graph graph(grid.Nodes() + 1);
  for (const auto& edges : by_row)
    for (const Edge& edge : edges) boost::add_edge(edge.from, edge.to, edge.cost, graph);
  return graph;
}

/// Start to goal along the graph; empty where there is no way.
Points Search(const Graph& graph, const Grid& grid, const Vector2d& goal) {
  const std::size_t count = grid.Nodes() + 1;
  std::vector<std::size_t> before(count);
  std::vector<double> costs(count);
  boost::dijkstra_shortest_paths(
      graph, grid.StartNode(),
      boost::predecessor_map(before.data()).distance_map(costs.data()).distance_inf(kInf));
  std::size_t node = count - 1;
  if (costs[node] == kInf) return {};
  Points points{goal};
  while (node != grid.StartNode()) {
    node = before[node];
    points.push_back(grid.At(node));
  }
  std::reverse(points.begin(), points.end());
  return points;
}

/// The cheapest choice of some of the points in their order.
Points Shortcut(const PathCost& cost, const Points& points, double spacing_m) {
  const std::size_t count = points.size();
  std::vector<double> best(count, kInf);
  std::vector<std::size_t> before(count, 0);
  best[0] = 0.0;
  for (std::size_t j = 1; j < count; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double by_i = best[i] + SegmentCost(cost, points[i], points[j], spacing_m);
      if (by_i < best[j]) best[j] = by_i, before[j] = i;
    }
  }
  Points chosen{points.back()};
  for (std::size_t j = count - 1; j != 0;) {
    j = before[j];
    chosen.push_back(points[j]);
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

/// Moves every inner point to where its two pieces cost least, in ever smaller steps.
void Relax(const PathCost& cost, Points& points, double spacing_m) {
  constexpr int kSweeps = 30;
  const auto around = [&](std::size_t i, const Vector2d& p) {
    return SegmentCost(cost, points[i - 1], p, spacing_m) +
           SegmentCost(cost, p, points[i + 1], spacing_m);
  };
  for (double step = 0.5 * spacing_m; step > 0.005 * spacing_m; step *= 0.5) {
    bool moved = true;
    for (int sweep = 0; moved && sweep < kSweeps; ++sweep) {
      moved = false;
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        double now = around(i, points[i]);
        for (const Vector2d& way :
             {Vector2d(step, 0), Vector2d(-step, 0), Vector2d(0, step), Vector2d(0, -step)}) {
          const double then = around(i, points[i] + way);
          if (!(then < now * (1.0 - 1e-12))) continue;
          now = then;
          points[i] += way;
          moved = true;
        }
      }
    }
  }
}

bool Inside(const PathProblem& problem, const Vector2d& p) {
  return (p.array() >= problem.low.array()).all() && (p.array() <= problem.high.array()).all();
}

}  // namespace

const char* Name(PathStatus status) {
  switch (status) {
    case PathStatus::kOk:
      return "ok";
    case PathStatus::kStartOrGoalOutside:
      return "start or goal outside the workspace";
    case PathStatus::kNoPath:
      return "no path";
  }
  return "?";
}

double LengthOf(const Points& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

double CostAlong(const PathCost& cost, const Points& points, double spacing_m) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i)
    sum += SegmentCost(cost, points[i - 1], points[i], spacing_m);
  return sum;
}

Points Resample(const Points& points, double spacing_m) {
  Points out;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d &a = points[i - 1], &b = points[i];
    const int count = std::max(1, int(std::ceil((b - a).norm() / spacing_m - 1e-9)));
    for (int k = 0; k < count; ++k) out.push_back(a + double(k) / count * (b - a));
  }
  if (!points.empty()) out.push_back(points.back());
  return out;
}

Path PlanPath(const PathCost& cost, const PathProblem& problem) {
  Path path;
  const double spacing = problem.spacing_m;
  const bool allowed =
      cost(problem.start, Vector2d::UnitX()) < kInf && cost(problem.goal, Vector2d::UnitX()) < kInf;
  if (!allowed || !Inside(problem, problem.start) || !Inside(problem, problem.goal)) {
    path.status = PathStatus::kStartOrGoalOutside;
    return path;
  }
  const Grid grid(problem);
  Points points = Search(MakeGraph(cost, problem, grid), grid, problem.goal);
  if (points.empty()) return path;
  points = Resample(Shortcut(cost, points, spacing), 2.0 * spacing);
  Relax(cost, points, spacing);
  path.status = PathStatus::kOk;
  path.length_m = LengthOf(points);
  path.cost = CostAlong(cost, points, spacing);
  path.points = std::move(points);
  return path;
}

}  // namespace flextip
