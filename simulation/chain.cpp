#include "simulation/chain.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kMaxIterations = 40;
constexpr double kMaxTurn = 0.4;         // rad, of one link in one step
constexpr double kStepTolerance = 1e-9;  // convergence is quadratic: what is left is rounding
constexpr int kS = 2, kR = 3, kF = 6;    // places in the border

}  // namespace

ChainGeometry::ChainGeometry(const ChainProblem& problem, double s)
    : n1_(problem.n1),
      n2_(problem.n2),
      h1_(s / problem.n1),
      h2_((1.0 - s) / problem.n2),
      dh1_(1.0 / problem.n1),
      dh2_(-1.0 / problem.n2) {}

double ChainGeometry::beyond(int link) const {
  return link < n1_ ? 1.0 - h1_ * (link + 0.5) : h2_ * (n1_ + n2_ - link - 0.5);
}

double ChainGeometry::dbeyond(int link) const {
  return link < n1_ ? -dh1_ * (link + 0.5) : dh2_ * (n1_ + n2_ - link - 0.5);
}

double ChainGeometry::ddc(int link) const {
  return 2.0 * djoint(link) * djoint(link) / std::pow(joint(link), 3);
}

std::vector<Eigen::Vector3d> ChainNodes(const ChainProblem& problem, const ChainState& state) {
  const ChainGeometry geometry(problem, state.s);
  std::vector<Eigen::Vector3d> nodes{Eigen::Vector3d::Zero()};
  for (int j = 0; j < problem.Links(); ++j) {
    nodes.emplace_back(nodes.back() + geometry.h(j) * state.u[j]);
  }
  return nodes;
}

ChainNewton::ChainNewton(const ChainProblem& problem)
    : problem_(problem), links_(static_cast<std::size_t>(problem.Links())) {
  assert(problem.n1 >= 4 && problem.n2 >= 4 && problem.load);
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

/// Residuals and second derivatives of the Lagrangian at `state`.
void ChainNewton::Assemble(const ChainState& state) {
  const ChainGeometry geometry(problem_, state.s);
  matrix_.setZero();
  vector_.setZero();
  for (int j = 0; j < problem_.Links(); ++j) AssembleLink(j, state, geometry);
  AssembleBorder(state, geometry);
  residual_ = vector_.tail<7>().squaredNorm() + vector_.head<2>().squaredNorm();
  for (int j = 0; j < problem_.Links(); ++j) {
    if (j != problem_.n1 - 1) residual_ += links_[j].residual.squaredNorm() / geometry.h(j);
  }
  residual_ = std::sqrt(residual_);
}

void ChainNewton::AssembleLink(int j, const ChainState& state, const ChainGeometry& geometry) {
  const int port_link = problem_.n1 - 1, last = problem_.Links() - 1;
  const Eigen::Vector3d& u = state.u[j];
  const double h = geometry.h(j), dh = geometry.dh(j);
  Eigen::Vector3d n = state.f + geometry.beyond(j) * problem_.q;  // internal force
  if (j <= port_link) n += state.r;
  const Eigen::Vector3d dn = geometry.dbeyond(j) * problem_.q;
  // Gradient with respect to u_j, its derivative with respect to s, and what s itself collects.
  Eigen::Vector3d gradient = -h * n;
  Eigen::Vector3d mixed = -dh * n - h * dn;
  vector_[kS] -= u.dot(dh * n + h * dn);
  matrix_(kS, kS) -= 2.0 * dh * u.dot(dn);
  if (j > 0) {
    gradient -= geometry.c(j - 1) * state.u[j - 1];
    mixed -= geometry.dc(j - 1) * state.u[j - 1];
  }
  if (j < last) {
    gradient -= geometry.c(j) * state.u[j + 1];
    mixed -= geometry.dc(j) * state.u[j + 1];
    const double bend = 0.5 * (state.u[j + 1] - u).squaredNorm();  // 1 - cos, without cancellation
    vector_[kS] += geometry.dc(j) * bend;
    matrix_(kS, kS) += geometry.ddc(j) * bend;
  }
  Link& link = links_[j];
  link.basis = NormalBasis(u);
  link.residual = link.basis.transpose() * gradient;
  link.diagonal = -u.dot(gradient) * Eigen::Matrix2d::Identity();
  link.border.setZero();
  link.border.col(kS) = link.basis.transpose() * mixed;
  if (j <= port_link) link.border.block<2, 3>(0, kR) = -h * link.basis.transpose();
  link.border.block<2, 3>(0, kF) = -h * link.basis.transpose();
}

/// The conditions on s, r and f, and the couplings that need two links' bases.
void ChainNewton::AssembleBorder(const ChainState& state, const ChainGeometry& geometry) {
  const int p = problem_.n1 - 1;
  Eigen::Vector3d sum1 = Eigen::Vector3d::Zero(), sum2 = Eigen::Vector3d::Zero();
  for (int j = 0; j <= p; ++j) sum1 += state.u[j];
  for (int j = p + 1; j < problem_.Links(); ++j) sum2 += state.u[j];
  const double h1 = geometry.h(p), h2 = geometry.h(p + 1);
  const ChainForce load = problem_.load(h1 * sum1 + h2 * sum2);
  stiffness_ = load.stiffness;

  for (int j = 0; j < p; ++j) {
    links_[j].next = -geometry.c(j) * links_[j].basis.transpose() * links_[j + 1].basis;
  }
  for (int j = p + 1; j < problem_.Links(); ++j) {
    links_[j].next = -geometry.c(j - 1) * links_[j].basis.transpose() * links_[j - 1].basis;
  }
  links_[p - 1].border.leftCols<2>() = links_[p - 1].next;
  links_[p + 1].border.leftCols<2>() = links_[p + 1].next;

  const Link& port = links_[p];
  vector_.head<2>() = port.residual;
  matrix_.topRows<2>() = port.border;
  matrix_.topLeftCorner<2, 2>() = port.diagonal;
  matrix_.bottomLeftCorner<7, 2>() = port.border.rightCols<7>().transpose();
  const Eigen::Vector3d dsum1 = -geometry.dh(p) * sum1;
  const Eigen::Vector3d dsum = dsum1 - geometry.dh(p + 1) * sum2;
  matrix_.block<1, 3>(kS, kR) = dsum1.transpose();
  matrix_.block<3, 1>(kR, kS) = dsum1;
  matrix_.block<1, 3>(kS, kF) = dsum.transpose();
  matrix_.block<3, 1>(kF, kS) = dsum;
  vector_.segment<3>(kR) = problem_.p_port - h1 * sum1;
  vector_.segment<3>(kF) = load.f - state.f;
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
  change.tail<3>() = -stiffness_ * change.tail<3>();
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
  // The last three rows are load(x_tip) - f = 0; their derivatives are those of x_tip (the rows of
  // the symmetric matrix with the opposite sign) times the load's stiffness.
  matrix_.bottomRows<3>() = (-stiffness_ * matrix_.bottomRows<3>()).eval();
  matrix_.bottomRightCorner<3, 3>() -= Eigen::Matrix3d::Identity();
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
  return moved;
}

}  // namespace flextip
