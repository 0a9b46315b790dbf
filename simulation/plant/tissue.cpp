#include "simulation/plant/tissue.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "simulation/plant/chain_geometry.h"

namespace flextip::simulation {
namespace {

constexpr int kElements = 24;  // evenly along the whole shaft
constexpr int kMaxIterations = 40, kHistory = 10;
constexpr double kTolerance = 1e-9;       // of the forces, relative, and of lengths
constexpr double kWorstTolerance = 1e-4;  // better than no shape, where the tissue is stiff

double Place(int element) { return (element + 0.5) / kElements; }

/// How much of an element's stretch of shaft is beyond the port.
double Engaged(int element, double s_port) {
  return std::clamp((element + 1.0) - s_port * kElements, 0.0, 1.0);
}

Eigen::VectorXd Stacked(const std::vector<TissueElement>& elements) {
  Eigen::VectorXd forces(3 * kElements);
  for (int k = 0; k < kElements; ++k) forces.segment<3>(3 * k) = elements[k].force_N_m;
  return forces;
}

/// Anderson's acceleration of x = g(x): the shaft smooths what the tissue does, so a handful of
/// directions holds all of it.
class Acceleration {
 public:
  Eigen::VectorXd Next(const Eigen::VectorXd& x, const Eigen::VectorXd& g) {
    const Eigen::VectorXd error = g - x;
    if (last_g_.size() > 0) {
      const int column = count_++ % kHistory;
      dg_.conservativeResize(g.size(), std::min(count_, kHistory));
      de_.conservativeResize(g.size(), std::min(count_, kHistory));
      dg_.col(column) = g - last_g_;
      de_.col(column) = error - last_error_;
    }
    last_g_ = g;
    last_error_ = error;
    if (count_ == 0) return g;
    return g - dg_ * LeastSquares(de_, error);
  }

 private:
  int count_ = 0;
  Eigen::MatrixXd dg_, de_;
  Eigen::VectorXd last_g_, last_error_;
};

}  // namespace

PlantTissue::PlantTissue(const ShaftTissue& tissue, const PlantUnits& units,
                         const Eigen::Vector3d& p_RW, double dt_s,
                         const std::vector<TissueElement>& before)
    : units_(units), p_RW_(p_RW), before_(before) {
  // Exact for a place that moves evenly during dt.
  const double x = std::max(0.0, dt_s) / tissue.time_constant_s;
  keep_ = std::exp(-x);
  spring_ = tissue.stiffness_N_m2 * (x > 1e-9 ? -std::expm1(-x) / x : 1.0);
}

std::vector<TissueElement> PlantTissue::At(const ChainProblem& problem,
                                           const ChainState& state) const {
  const ChainGeometry geometry(problem, state.s);
  const std::vector<Eigen::Vector3d> nodes = ChainNodes(problem, state);
  std::vector<TissueElement> after(kElements);
  for (int k = 0; k < kElements; ++k) {
    const ChainPlace at = geometry.At(Place(k));
    after[k].p = p_RW_ + units_.length_m * (nodes[at.link] + at.d * state.u[at.link]);
    if (before_.empty() || Engaged(k, state.s) == 0.0) continue;
    after[k].force_N_m = keep_ * before_[k].force_N_m - spring_ * (after[k].p - before_[k].p);
  }
  return after;
}

void PlantTissue::Apply(const std::vector<TissueElement>& elements, const ChainState& state,
                        ChainProblem& problem) const {
  problem.points.clear();
  const double to_chain = units_.length_m / units_.force_N / kElements;
  for (int k = 0; k < kElements; ++k) {
    const double engaged = Engaged(k, state.s);
    if (engaged > 0) {
      problem.points.push_back({Place(k), engaged * to_chain * elements[k].force_N_m});
    }
  }
}

bool PlantTissue::Solve(ChainProblem& problem, ChainState& state, const ChainSolve& solve) const {
  const double floor = spring_ * units_.length_m;  // what the places are good for
  Acceleration acceleration;
  double error = 1.0;
  std::vector<TissueElement> elements = At(problem, state);
  for (int i = 0; i < kMaxIterations; ++i) {
    Apply(elements, state, problem);
    if (!solve(problem, state)) return false;
    const Eigen::VectorXd used = Stacked(elements);
    elements = At(problem, state);
    const Eigen::VectorXd found = Stacked(elements);
    error = (found - used).norm() / (found.norm() + floor);
    if (error <= kTolerance) return true;
    const Eigen::VectorXd next = acceleration.Next(used, found);
    for (int k = 0; k < kElements; ++k) elements[k].force_N_m = next.segment<3>(3 * k);
  }
  return error < kWorstTolerance;
}

}  // namespace flextip::simulation
