// The rod solved the way a textbook does it, for the benchmark to compare with: unknowns at the
// wrist, fourth-order Runge-Kutta to the tip, Jacobian by forward differences, Newton.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "core/linear_algebra.h"
#include "kinematics/rod.h"

namespace flextip {

class TextbookRod {
 public:
  /// Starts from the last solution. Includes d tip / d wrist by differences, as the rod does.
  bool Solve(const RodProblem& problem) {
    if (!started_) Start(problem);
    if (!Newton(problem, x_)) return false;
    const Eigen::Vector3d tip = TipPosition();
    for (int j = 0; j < 3; ++j) {
      RodProblem moved = problem;
      moved.p_wrist[j] += 1e-6;
      Vector8 x = x_;
      if (!Newton(moved, x)) return false;
      jacobian_.col(j) = (tip_ - tip) / 1e-6;
    }
    tip_ = tip;
    return true;
  }
  const Eigen::Vector3d& TipPosition() const { return tip_; }

 private:
  using Vector8 = Eigen::Matrix<double, 8, 1>;
  using State = Eigen::Matrix<double, 9, 1>;  // p, t, m

  void Start(const RodProblem& problem) {
    const Eigen::Vector3d t = (problem.p_port - problem.p_wrist).normalized();
    const double a = (problem.p_port - problem.p_wrist).norm();
    const Eigen::Vector3d f_port = -problem.f_tip * (problem.length_m / a);
    x_ << std::atan2(t.y(), t.x()), std::asin(t.z()), -(f_port + problem.f_tip), f_port.y(),
        f_port.z(), a;
    for (double part = 0.05; part <= 1.0; part += 0.05) {
      RodProblem lighter = problem;
      lighter.f_tip *= part;
      if (part == 0.05) x_.segment<5>(2) *= part;
      Newton(lighter, x_);
    }
    started_ = true;
  }

  static State Rate(const State& y, const Eigen::Vector3d& n, double EI) {
    const Eigen::Vector3d t = y.segment<3>(3), m = y.tail<3>();
    State rate;
    rate << t, m.cross(t) / EI, n.cross(t);
    return rate;
  }

  static void Integrate(State& y, Eigen::Vector3d n, const RodProblem& problem, double length) {
    constexpr int kSteps = 20;
    const double h = length / kSteps, EI = problem.bending_stiffness_Nm2;
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::Vector3d n_half = n - 0.5 * h * problem.q_weight,
                            n_end = n - h * problem.q_weight;
      const State k1 = Rate(y, n, EI), k2 = Rate(y + 0.5 * h * k1, n_half, EI);
      const State k3 = Rate(y + 0.5 * h * k2, n_half, EI), k4 = Rate(y + h * k3, n_end, EI);
      y += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4);
      n = n_end;
    }
  }

  /// Unknowns: two angles of the wrist tangent, internal force at the wrist, two components of the
  /// port's force (its part along the shaft is left to the third), place of the port.
  Vector8 Residual(const RodProblem& problem, const Vector8& x) {
    State y = State::Zero();
    y.head<3>() = problem.p_wrist;
    y.segment<3>(3) << std::cos(x[1]) * std::cos(x[0]), std::cos(x[1]) * std::sin(x[0]),
        std::sin(x[1]);
    Eigen::Vector3d n = x.segment<3>(2);
    Integrate(y, n, problem, x[7]);
    Vector8 r;
    r.head<3>() = y.head<3>() - problem.p_port;
    const Eigen::Vector3d t = y.segment<3>(3);
    // The force normal to t whose y and z components are the unknowns.
    Eigen::Vector3d f(0.0, x[5], x[6]);
    f.x() = -(t.y() * f.y() + t.z() * f.z()) / t.x();
    n = n - x[7] * problem.q_weight - f;
    Integrate(y, n, problem, problem.length_m - x[7]);
    n -= (problem.length_m - x[7]) * problem.q_weight;
    r.segment<3>(3) = n - problem.f_tip;
    const Eigen::Vector3d t_tip = y.segment<3>(3), m = y.tail<3>();
    r[6] = m.y() * t_tip.x() - m.x() * t_tip.y();
    r[7] = m.z() * t_tip.x() - m.x() * t_tip.z();
    tip_ = y.head<3>();
    return r;
  }

  bool Newton(const RodProblem& problem, Vector8& x) {
    for (int i = 0; i < 20; ++i) {
      const Vector8 r = Residual(problem, x);
      if (r.norm() < 1e-9) return true;
      Eigen::Matrix<double, 8, 8> J;
      for (int j = 0; j < 8; ++j) {
        Vector8 moved = x;
        moved[j] += 1e-7;
        J.col(j) = (Residual(problem, moved) - r) / 1e-7;
      }
      x -= Lu(J).Solve(r);
    }
    return false;
  }

  bool started_ = false;
  Vector8 x_ = Vector8::Zero();
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d jacobian_ = Eigen::Matrix3d::Zero();
};

}  // namespace flextip
