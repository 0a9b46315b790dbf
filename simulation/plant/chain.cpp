#include "simulation/plant/chain.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace flextip::simulation {
namespace {

constexpr int kMaxIterations = 40;
constexpr double kMaxTurn = 0.4;         // rad, of one link in one step
constexpr double kStepTolerance = 1e-9;  // convergence is quadratic: what is left is rounding

}  // namespace

ChainNewton::ChainNewton(const ChainProblem& problem)
    : problem_(problem),
      curved_(problem.IsCurved()),
      pointed_(!problem.points.empty() || problem.contact),
      links_(static_cast<std::size_t>(problem.Links())),
      loads_(pointed_ ? links_.size() : 0),
      gradient_(links_.size()),
      mixed_(links_.size()) {
  FLEXTIP_CHECK(problem.n1 >= 4 && problem.n2 >= 4 && problem.load,
                "four links on either side, and a load");
}

ChainNewton::Result ChainNewton::Solve(ChainState& state) {
  Result result;
  Assemble(state);
  for (result.iterations = 1; result.iterations <= kMaxIterations; ++result.iterations) {
    if (!std::isfinite(residual_) || !ComputeStep()) break;
    const double size = StepSize();
    if (!std::isfinite(size)) break;
    const double before = residual_;
    double fraction = std::min(1.0, kMaxTurn / size);
    ChainState moved = Moved(state, fraction);
    Assemble(moved);
    for (int halving = 0; halving < 8 && !(residual_ < before) && size > 1e-6; ++halving) {
      fraction *= 0.5;
      moved = Moved(state, fraction);
      Assemble(moved);
    }
    state = std::move(moved);
    if (size < kStepTolerance) {
      result.converged = std::isfinite(residual_);
      break;
    }
  }
  result.residual = residual_;
  return result;
}

/// Takes link j out of the system (block elimination); its row stays for the way back.
bool ChainNewton::Eliminate(int j, int next) {
  Link& link = links_[j];
  const double determinant = link.diagonal.determinant();
  if (!(std::abs(determinant) > 1e-12 * link.diagonal.squaredNorm())) return false;
  link.inverse = link.diagonal.inverse();
  const Eigen::Matrix<double, 2, kBorder> scaled = link.inverse * link.border;
  const Eigen::Vector2d scaled_residual = link.inverse * link.residual;
  matrix_.noalias() -= link.border.transpose() * scaled;
  BorderVector change = link.border.transpose() * scaled_residual;
  change.segment<3>(kF) = -stiffness_ * change.segment<3>(kF);
  change[kC] *= contact_slope_;
  vector_ -= change;
  if (next == problem_.n1 - 1) return true;  // the link at the port is in the border
  Link& after = links_[next];
  after.diagonal.noalias() -= link.next.transpose() * link.inverse * link.next;
  after.border.noalias() -= link.next.transpose() * scaled;
  after.residual.noalias() -= link.next.transpose() * scaled_residual;
  return true;
}

/// Solves for the step: both sides are eliminated toward the port, then the border, then back.
bool ChainNewton::ComputeStep() {
  const int p = problem_.n1 - 1, links = problem_.Links();
  for (int j = 0; j < p; ++j) {
    if (!Eliminate(j, j + 1)) return false;
  }
  for (int j = links - 1; j > p; --j) {
    if (!Eliminate(j, j - 1)) return false;
  }
  // The rows of f are load(x_tip) - f = 0; their derivatives are those of x_tip (the rows of the
  // symmetric matrix with the opposite sign) times the load's stiffness. So is the contact's row,
  // with its depth.
  matrix_.middleRows<3>(kF) = (-stiffness_ * matrix_.middleRows<3>(kF)).eval();
  matrix_.block<3, 3>(kF, kF) -= Eigen::Matrix3d::Identity();
  matrix_.row(kC) *= contact_slope_;
  matrix_(kC, kC) -= 1.0;
  const Eigen::PartialPivLU<Border> lu(matrix_);
  if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 1e-14)) return false;
  border_step_ = lu.solve(-vector_);
  links_[p].step = border_step_.head<2>();
  const auto back = [&](int j, int next) {
    Link& link = links_[j];
    Eigen::Vector2d right = -link.residual - link.border * border_step_;
    if (next != p) right -= link.next * links_[next].step;
    link.step = link.inverse * right;
  };
  for (int j = p - 1; j >= 0; --j) back(j, j + 1);
  for (int j = p + 1; j < links; ++j) back(j, j - 1);
  return true;
}

/// The largest turn of a link, or the relative change of the two lengths where that is larger.
double ChainNewton::StepSize() const {
  double size = std::abs(border_step_[kS]);
  for (const Link& link : links_) size = std::max(size, link.step.norm());
  return size;
}

ChainState ChainNewton::Moved(const ChainState& state, double fraction) const {
  ChainState moved = state;
  for (int j = 0; j < problem_.Links(); ++j) {
    const Eigen::Vector3d turn = links_[j].basis * (fraction * links_[j].step);
    const double angle = turn.norm();
    if (angle > 0) {
      moved.u[j] = (std::cos(angle) * state.u[j] + std::sin(angle) / angle * turn).normalized();
    }
  }
  const double s = state.s + fraction * border_step_[kS];
  moved.s = std::clamp(s, 0.5 * state.s, 0.5 * (1.0 + state.s));
  moved.r += fraction * border_step_.segment<3>(kR);
  moved.f += fraction * border_step_.segment<3>(kF);
  moved.contact += fraction * border_step_[kC];
  return moved;
}

}  // namespace flextip::simulation
