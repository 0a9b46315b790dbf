#include "tests/vision/outline_scene.h"

#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "tests/vision/scope_scene.h"

namespace flextip {

TubeShape ScopeTube() {
  TubeShape tube;
  tube.diameter_m = 0.005;
  tube.collar = TubeShape::Collar{-0.0195, -0.0105, 0.007};
  return tube;
}

simulation::ShaftCurve BentScopeShaft(const Pose& T_RE, const Eigen::Vector2d& bend) {
  simulation::ShaftCurve curve;
  curve.diameter_m = ScopeTube().diameter_m;
  curve.T_RE = T_RE;
  constexpr int kPieces = 100;
  for (int i = kPieces; i >= 0; --i) {
    curve.points.push_back(T_RE * TubeCentre(bend, 0.12 * i / kPieces).x_E);
  }
  return curve;
}

simulation::Occluder CoverOfTheCollar(int first, int last) {
  const Pose& T_RC = ScopeCamera().T_RC;
  simulation::Occluder other;
  other.a_R = T_RC * Eigen::Vector3d(0.004, -0.05, 0.06);
  other.b_R = T_RC * Eigen::Vector3d(-0.002, 0.05, 0.06);
  other.radius_m = 0.0042;
  other.albedo_bgr = {0.15, 0.15, 0.15};
  other.specular = 0.6;
  other.first_frame = first;
  other.last_frame = last;
  return other;
}

double PositionNees(const Eigen::Vector3d& p_RE, const Eigen::Matrix3d& covariance_m2,
                    const Pose& truth) {
  const Eigen::Vector3d e = p_RE - truth.p;
  return MahalanobisSquared(e, covariance_m2);
}

double DirectionNees(const TipPrediction& tip, const Pose& truth) {
  const Eigen::Matrix<double, 2, 3> across = NormalBasis(truth.R.col(0)).transpose();
  const Eigen::Vector2d e = across * LogRotation(tip.T_RE.R * truth.R.transpose());
  const Eigen::Matrix2d S = across * tip.covariance.topLeftCorner<3, 3>() * across.transpose();
  return MahalanobisSquared(e, S);
}

}  // namespace flextip
