#include "vision/tags/collar_pose.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "vision/tags/planar_pose.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

// A collar's tag together with its detection.
struct SeenTag {
  const CollarTag* tag;
  const TagDetection* detection;
};

// Two minima nearer than this count as one.
constexpr double kSamePose_rad = 0.02;
// Twice the log of the odds below which the second minimum is still believed possible: 100 to 1.
constexpr double kAmbiguousChi2 = 9.2;

// Keeps one detection an id. Of several (a reflection, say) only the most contrasted can be
// trusted.
std::vector<SeenTag> MatchTags(const TagCollar& collar, const std::vector<TagDetection>& tags) {
  std::vector<SeenTag> seen;
  for (const CollarTag& tag : collar.tags) {
    const TagDetection* best = nullptr;
    for (const TagDetection& d : tags) {
      if (d.id == tag.id && (!best || d.decision_margin > best->decision_margin)) best = &d;
    }
    if (best) seen.push_back({&tag, best});
  }
  return seen;
}

std::vector<Correspondence> Correspondences(const std::vector<SeenTag>& seen) {
  std::vector<Correspondence> points;
  for (const SeenTag& s : seen) {
    const auto corners_E = CornersInE(*s.tag);
    for (int i = 0; i < 4; ++i) points.push_back({corners_E[i], s.detection->corners_px[i]});
  }
  return points;
}

std::vector<Pose> Starts(const CameraModel& camera, const std::vector<SeenTag>& seen,
                         const std::optional<Pose>& near_T_CE) {
  std::vector<Pose> starts;
  for (const SeenTag& s : seen) {
    const Pose T_GE = s.tag->T_EG.Inverse();
    for (const Pose& T_CG : PlanarPoses(camera, s.tag->size_m, s.detection->corners_px)) {
      starts.push_back(T_CG * T_GE);
    }
  }
  if (near_T_CE) starts.push_back(*near_T_CE);
  return starts;
}

double AngleBetween(const Pose& a, const Pose& b) { return PoseDifference(a, b).head<3>().norm(); }

// Returns whether all seen tags show their faces under a pose.
bool AllTagsFaceTheCamera(const Pose& T_CE, const std::vector<SeenTag>& seen) {
  return std::all_of(seen.begin(), seen.end(), [&](const SeenTag& s) {
    const Pose T_CG = T_CE * s.tag->T_EG;
    return T_CG.R.col(2).dot(T_CG.p) > 0;
  });
}

// Returns the distinct minima that the starts lead to, the best first.
std::vector<PoseMinimum> Minima(const CameraModel& camera, const std::vector<SeenTag>& seen,
                                const std::vector<Pose>& starts, int max_iterations) {
  const std::vector<Correspondence> points = Correspondences(seen);
  std::vector<PoseMinimum> minima;
  for (const Pose& start : starts) {
    const auto minimum = MinimiseReprojection(camera, points, start, max_iterations);
    if (minimum && AllTagsFaceTheCamera(minimum->T_CE, seen)) minima.push_back(*minimum);
  }
  std::sort(minima.begin(), minima.end(), [](const PoseMinimum& a, const PoseMinimum& b) {
    return a.error.squared_px2 < b.error.squared_px2;
  });
  std::vector<PoseMinimum> distinct;
  for (const PoseMinimum& m : minima) {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const PoseMinimum& d) {
      return AngleBetween(d.T_CE, m.T_CE) < kSamePose_rad;
    });
    if (!known) distinct.push_back(m);
  }
  return distinct;
}

double Rms(const PoseMinimum& m, std::size_t tags) {
  return std::sqrt(m.error.squared_px2 / (4.0 * static_cast<double>(tags)));
}

std::vector<PoseMinimum> FitAll(const CameraModel& camera, const std::vector<SeenTag>& seen,
                                const CollarPoseOptions& options,
                                const std::optional<Pose>& near_T_CE) {
  return Minima(camera, seen, Starts(camera, seen, near_T_CE), options.max_iterations);
}

// Fits all tags. While that is poor and two tags would stay, leaves out the tag without which the
// rest fits best.
std::vector<PoseMinimum> FitWithoutOutliers(const CameraModel& camera, std::vector<SeenTag>& seen,
                                            const CollarPoseOptions& options,
                                            const std::optional<Pose>& near_T_CE) {
  auto minima = FitAll(camera, seen, options, near_T_CE);
  while (seen.size() > 2 && (minima.empty() || Rms(minima[0], seen.size()) > options.max_rms_px)) {
    std::vector<SeenTag> best_rest;
    std::vector<PoseMinimum> best;
    for (std::size_t left_out = 0; left_out < seen.size(); ++left_out) {
      std::vector<SeenTag> rest = seen;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left_out));
      auto fit = FitAll(camera, rest, options, near_T_CE);
      const bool better =
          !fit.empty() && (best.empty() || fit[0].error.squared_px2 < best[0].error.squared_px2);
      if (better || best_rest.empty()) {
        best_rest = rest;
        best = fit;
      }
    }
    seen = best_rest;
    minima = best;
  }
  return minima;
}

// Returns the corners' noise from this fit and earlier ones, never below the floor.
double CornerNoise(const PoseMinimum& m, int dof, const CollarPoseOptions& o) {
  const double variance =
      (o.prior_variance_px2 * o.prior_dof + m.error.squared_px2) / std::max(1.0, o.prior_dof + dof);
  return std::max(o.corner_noise_floor_px, std::sqrt(variance));
}

// Chooses between the two best minima and, where nothing but chance decides, adds the distance
// between them to the covariance.
void ResolveAmbiguity(const std::vector<PoseMinimum>& minima, const std::optional<Pose>& near_T_CE,
                      CollarPose& pose, const PoseMinimum*& chosen) {
  if (minima.size() < 2) return;
  const double variance = pose.corner_noise_px * pose.corner_noise_px;
  const double chi2 = (minima[1].error.squared_px2 - minima[0].error.squared_px2) / variance;
  pose.ambiguous = chi2 < kAmbiguousChi2;
  pose.alternative = minima[1].T_CE;
  if (!pose.ambiguous) return;
  if (near_T_CE) {
    if (AngleBetween(minima[1].T_CE, *near_T_CE) < AngleBetween(minima[0].T_CE, *near_T_CE)) {
      chosen = &minima[1];
      pose.alternative = minima[0].T_CE;
    }
    return;
  }
  const double odds = std::exp(-0.5 * chi2);
  const Eigen::Matrix<double, 6, 1> apart = PoseDifference(minima[0].T_CE, minima[1].T_CE);
  pose.covariance += odds / (1 + odds) * apart * apart.transpose();
}

}  // namespace

std::array<Eigen::Vector3d, 4> CornersInE(const CollarTag& tag) {
  const double h = 0.5 * tag.size_m;
  return {tag.T_EG * Eigen::Vector3d(-h, h, 0), tag.T_EG * Eigen::Vector3d(h, h, 0),
          tag.T_EG * Eigen::Vector3d(h, -h, 0), tag.T_EG * Eigen::Vector3d(-h, -h, 0)};
}

CollarPose EstimateCollarPose(const CameraModel& camera, const TagCollar& collar,
                              const std::vector<TagDetection>& tags,
                              const CollarPoseOptions& options,
                              const std::optional<Pose>& near_T_CE) {
  CollarPose pose;
  std::vector<SeenTag> seen = MatchTags(collar, tags);
  if (seen.empty()) return pose;
  pose.status = CollarPoseStatus::kNotConverged;
  const auto minima = FitWithoutOutliers(camera, seen, options, near_T_CE);
  if (minima.empty()) return pose;

  const PoseMinimum* chosen = &minima[0];
  pose.tags_used = static_cast<int>(seen.size());
  pose.dof = 8 * pose.tags_used - 6;
  pose.corner_noise_px = CornerNoise(*chosen, pose.dof, options);
  ResolveAmbiguity(minima, near_T_CE, pose, chosen);
  const Ldlt information(chosen->error.JtJ);
  if (!information.Succeeded() || information.ReciprocalCondition() < 1e-18) return pose;
  pose.covariance += pose.corner_noise_px * pose.corner_noise_px * information.Inverse();
  pose.T_CE = chosen->T_CE;
  pose.squared_error_px2 = chosen->error.squared_px2;
  pose.rms_px = Rms(*chosen, seen.size());
  pose.status =
      pose.rms_px <= options.max_rms_px ? CollarPoseStatus::kOk : CollarPoseStatus::kPoorFit;
  return pose;
}

}  // namespace flextip
