// The collar's localiser: which of two poses, where one plane is in view.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rotation.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/collar_localiser.h"

namespace flextip {
namespace {

constexpr double kAmbiguousRatio = 30.0;     // twice the log of the odds
constexpr double kAmbiguousPerPixel = 0.15;  // log of the ratio of the noises
constexpr int kPlanarChecksSpared = 4;
constexpr double kSmallTurn_rad = 0.08;

// The pose under which a tag, seen as from T_CE, looks nearly the same: turned about its centre so
// that the normal comes to lie on the other side of the line of sight.
Pose OtherPlanarPose(const Pose& T_CE, const Pose& T_EG) {
  const Pose T_CG = T_CE * T_EG;
  const Eigen::Vector3d normal = T_CG.R.col(2), sight = T_CG.p.normalized();
  const Eigen::Vector3d axis = normal.cross(sight);
  const double angle = std::atan2(axis.norm(), normal.dot(sight));
  if (axis.norm() < 1e-6) return T_CE;
  const Pose turned{ExpRotation(2 * angle * axis.normalized()) * T_CG.R, T_CG.p};
  return turned * T_EG.Inverse();
}

}  // namespace

// Where the other planar pose was clearly worse, it is for some frames: a tip does not jump to it.
bool CollarLocaliser::MaySkipPlanarCheck(const Sight& sight, const Pose& expected_T_RE) {
  const double turn = PoseDifference(expected_T_RE, sight.T_RE).head<3>().norm();
  if (planar_checks_spared_ == 0 || turn > kSmallTurn_rad) return false;
  --planar_checks_spared_;
  return true;
}

// With one plane in view two poses may fit: tries the other, keeps the likelier, and where both
// are nearly as likely takes the one that is expected.
void CollarLocaliser::CheckOtherPlanarPose(const Images& images,
                                           const std::optional<Pose>& near_T_RE, Sight& sight) {
  planar_checks_spared_ = 0;
  if (sight.source != TrackSource::kPixels || !sight.pixels.one_plane) return;
  planar_checks_spared_ = kPlanarChecksSpared;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] == nullptr || sight.pixels.views[i].faces.empty()) continue;
    const auto tag = std::find_if(
        collar_.tags.begin(), collar_.tags.end(),
        [&](const CollarTag& t) { return t.id == sight.pixels.views[i].faces[0].tag_id; });
    const Pose& T_RC = models_[i]->Calibration().T_RC;
    const Pose other = T_RC * OtherPlanarPose(T_RC.Inverse() * sight.T_RE, tag->T_EG);
    Sight second = FitPixels(images, other, true, &sight.pixels);
    if (!second.Found()) return;
    const double apart = PoseDifference(sight.T_RE, second.T_RE).head<3>().norm();
    if (apart < 0.02) return;  // the same minimum
    double ratio = LogLikelihoodRatio2(sight.pixels, second.pixels);
    // Residuals that are not noise (glare, blur) go together: their number proves little.
    const bool unclear = std::abs(ratio) < kAmbiguousRatio ||
                         std::abs(ratio) < 2 * kAmbiguousPerPixel * sight.pixels.pixels;
    bool swap = ratio < 0;
    if (unclear && near_T_RE) {
      swap = PoseDifference(*near_T_RE, second.T_RE).head<3>().norm() <
             PoseDifference(*near_T_RE, sight.T_RE).head<3>().norm();
    }
    if (swap) std::swap(sight, second);
    sight.alternative_T_RE = second.T_RE;
    sight.ambiguous = unclear;
    if (unclear) planar_checks_spared_ = 0;
    if (unclear && !near_T_RE) {
      const Eigen::Matrix<double, 6, 1> difference = PoseDifference(sight.T_RE, second.T_RE);
      sight.covariance += 0.5 * difference * difference.transpose();
    }
    return;
  }
}

}  // namespace flextip
