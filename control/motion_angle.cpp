// phi_max in three dimensions.
#include <cmath>
#include <numbers>

#include "control/angle_search.h"
#include "control/motion_error.h"

namespace flextip {
namespace {

/// False only where J has full rank by the singular values of A and J_hat.
bool MayBeSingular(const Eigen::Vector3d& sigma, const Eigen::Vector3d& sigma_hat) {
  const double condition_hat = sigma_hat.maxCoeff() / sigma_hat.minCoeff();
  return sigma.minCoeff() <= 1e-14 * condition_hat * sigma.maxCoeff();
}

/// Fills in `error` from A's decomposition.
void FindInSpace(const AnglePencil& pencil, AngleError<3>& error) {
  // The sign of K's least eigenvalue is the same at all x, but at some it may be lost in rounding.
  const PencilPoint low = pencil.Evaluate(pencil.SmallestX());
  const PencilPoint high = pencil.Evaluate(pencil.LargestX());
  const PencilPoint middle = pencil.Evaluate(std::sqrt(low.x * high.x));
  PencilPoint start = low;
  for (const PencilPoint& point : {middle, high}) {
    if (point.cosine < start.cosine) start = point;
  }
  AngleCandidate best;
  if (start.cosine < 0.0) {
    if (!SearchObtuse(pencil, start, best)) error.status = MotionErrorStatus::kNotConverged;
  } else if (pencil.HasUnmoved()) {
    // Motions next to one that is not made are made square to it at least.
    error.phi_max_rad = 0.5 * std::numbers::pi;
    error.p_phi = pencil.Unmoved();
    return;
  } else {
    best =
        middle.balance > 0.0 ? SearchAcute(pencil, middle, high) : SearchAcute(pencil, low, middle);
  }
  const Eigen::Vector3d direction = pencil.Direction(best.x, best.y);
  if (!(best.angle >= 0.0) || !direction.allFinite()) {
    error.status = MotionErrorStatus::kNotConverged;  // sizes so far apart that numbers overflow
    return;
  }
  error.phi_max_rad = best.angle;
  error.p_phi = direction;
}

}  // namespace

AngleError<3> FindLargestAngle(const Eigen::Matrix3d& J, const Eigen::Matrix3d& J_hat) noexcept {
  AngleError<3> error;
  const double size = J.cwiseAbs().maxCoeff(), size_hat = J_hat.cwiseAbs().maxCoeff();
  if (!J.allFinite() || !J_hat.allFinite()) return error;
  error.status = MotionErrorStatus::kSingularEstimate;
  if (size_hat == 0.0) return error;
  const SmallSvd svd_hat = DecomposeSmall(J_hat / size_hat);
  if (MissingRank(svd_hat.sigma) > 0) return error;
  error.status = MotionErrorStatus::kSingularTruth;
  if (size == 0.0) return error;
  const Eigen::Matrix3d J_scaled = J / size;
  // A = J V_hat Sigma_hat^-1 U_hat^T, but for the factor U_hat^T, which goes to the right vectors.
  SmallSvd svd = DecomposeSmall(J_scaled * svd_hat.V * svd_hat.sigma.cwiseInverse().asDiagonal());
  svd.V = svd_hat.U * svd.V;
  const int missing_rank =
      MayBeSingular(svd.sigma, svd_hat.sigma) ? MissingRank(DecomposeSmall(J_scaled).sigma) : 0;
  if (missing_rank == 0) error.status = MotionErrorStatus::kOk;
  FindInSpace(AnglePencil(svd, missing_rank), error);
  return error;
}

}  // namespace flextip
