#include "apps/track/summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace flextip {
namespace {

void AddScores(const TrackSums& sums, nlohmann::json& summary) {
  const TipScore& ok = sums.score;
  const TipScore& predicted = sums.score_predicted;
  summary["scored_frames"] = ok.frames;
  summary["scored_frames_predicted"] = predicted.frames;
  if (ok.frames > 0) {
    summary["tip_rms_error_m"] = ok.RmsError();
    summary["tip_max_error_m"] = ok.max_error_m;
    summary["tip_rms_error_across_m"] = ok.RmsAcross();
    summary["tip_rms_error_depth_m"] = ok.RmsDepth();
    summary["tip_mean_nees"] = ok.MeanNees();
    summary["tip_share_inside_95"] = ok.ShareInside();
  }
  if (predicted.frames > 0) {
    summary["predicted_tip_rms_error_m"] = predicted.RmsError();
    summary["predicted_tip_max_error_m"] = predicted.max_error_m;
    summary["predicted_tip_mean_nees"] = predicted.MeanNees();
    summary["predicted_tip_share_inside_95"] = predicted.ShareInside();
  }
}

}  // namespace

nlohmann::json TrackSummary(const TrackSums& sums, int cameras, bool scored) {
  const auto frames = static_cast<double>(sums.frames);
  nlohmann::json summary = {{"frames", sums.frames},
                            {"ok", sums.ok},
                            {"predicted", sums.predicted},
                            {"lost", sums.lost},
                            {"frames_by_pixels", sums.by_pixels},
                            {"frames_by_corners", sums.by_corners},
                            {"cameras", cameras},
                            {"frames_per_second", frames / std::max(sums.seconds, 1e-9)},
                            {"tags_per_frame", static_cast<double>(sums.tags) / frames}};
  if (sums.not_by_wrist > 0) {
    summary["not_by_wrist"] = sums.not_by_wrist;
    summary["from_wrist_mean_m"] = sums.from_wrist_m / static_cast<double>(sums.not_by_wrist);
  }
  if (sums.not_by_collar > 0) summary["not_by_collar"] = sums.not_by_collar;
  if (sums.stood_still > 0) summary["stood_still"] = sums.stood_still;
  if (sums.by_corners > 0) {
    summary["rms_reprojection_error_px"] = sums.Corners_px();
  }
  if (sums.by_pixels > 0) summary["noise_grey"] = sums.Noise_grey();
  if (scored) AddScores(sums, summary);
  return summary;
}

}  // namespace flextip
