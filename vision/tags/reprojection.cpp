#include "vision/tags/reprojection.h"

#include <cmath>
#include <functional>

#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {

Pose MovePose(const Pose& T_CE, const Eigen::Matrix<double, 6, 1>& step) {
  return {ExpRotation(step.head<3>()) * T_CE.R, T_CE.p + step.tail<3>()};
}

Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& from, const Pose& to) {
  Eigen::Matrix<double, 6, 1> step;
  step << LogRotation(to.R * from.R.transpose()), to.p - from.p;
  return step;
}

Eigen::Matrix<double, 6, 6> Turned(const Eigen::Matrix<double, 6, 6>& covariance_B,
                                   const Eigen::Matrix3d& R_AB) {
  Eigen::Matrix<double, 6, 6> Q = Eigen::Matrix<double, 6, 6>::Zero();
  Q.topLeftCorner<3, 3>() = Q.bottomRightCorner<3, 3>() = R_AB;
  return Q * covariance_B * Q.transpose();
}

Eigen::Matrix<double, 6, 1> Turned(const Eigen::Matrix<double, 6, 1>& step_B,
                                   const Eigen::Matrix3d& R_AB) {
  Eigen::Matrix<double, 6, 1> step_A;
  step_A << R_AB * step_B.head<3>(), R_AB * step_B.tail<3>();
  return step_A;
}

std::optional<ReprojectionError> Reproject(const CameraModel& camera,
                                           const std::vector<Correspondence>& points,
                                           const Pose& T_CE) {
  ReprojectionError sum;
  for (const Correspondence& point : points) {
    const Eigen::Vector3d rotated = T_CE.R * point.x_E;
    Eigen::Matrix<double, 2, 3> J_point;
    const auto px = camera.Project(rotated + T_CE.p, &J_point);
    if (!px) return {};
    const Eigen::Vector2d residual = *px - point.px;
    Eigen::Matrix<double, 2, 6> J;
    J << -J_point * Skew(rotated), J_point;
    sum.squared_px2 += residual.squaredNorm();
    sum.JtJ.noalias() += J.transpose() * J;
    sum.Jtr.noalias() += J.transpose() * residual;
  }
  return sum;
}

std::optional<PoseMinimum> MinimiseReprojection(const CameraModel& camera,
                                                const std::vector<Correspondence>& points,
                                                const Pose& start, int max_iterations) {
  const auto first = Reproject(camera, points, start);
  if (!first) return {};
  PoseMinimum at{start, *first}, next = at;
  bool finite = true;
  const auto try_step = [&](double damping) -> TrialStep {
    Eigen::Matrix<double, 6, 6> A = at.error.JtJ;
    A.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, 6, 1> step = -Ldlt(A).Solve(at.error.Jtr);
    finite = step.allFinite();
    // The decrease that the quadratic model promises; below it there is only rounding left.
    const double promised = -step.dot(2 * at.error.Jtr + at.error.JtJ * step);
    if (!finite || promised < 1e-12 * (at.error.squared_px2 + 1e-12)) {
      next = at;
      return {.cost = at.error.squared_px2, .settled = true};
    }
    next.T_CE = MovePose(at.T_CE, step);
    const auto error = Reproject(camera, points, next.T_CE);
    if (!error || !(error->squared_px2 < at.error.squared_px2)) return {};
    next.error = *error;
    return {.cost = error->squared_px2};
  };
  const auto accept = [&] { at = next; };
  const DescentResult descent = Descend(at.error.squared_px2, std::ref(try_step), std::ref(accept),
                                        {.max_iterations = max_iterations,
                                         .start_damping = 1e-4,
                                         .least_raised = 0.0,
                                         .most_damping = 1e10,
                                         .relative_gain = 0.0});
  if (!finite || (!descent.settled && !descent.exhausted)) return {};
  return at;
}

}  // namespace flextip
