#include "pipeline/track_totals.h"

#include <cmath>

namespace flextip {
namespace {

double Mean(double sum, long count) { return count > 0 ? sum / static_cast<double>(count) : 0.0; }

double RootMean(double squares, long count) {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

}  // namespace

void TrackSums::Add(const TipTrack& track) {
  ++frames;
  tags += static_cast<long>(track.tags.size());
  predicted += track.tip.status == TipStatus::kPredicted;
  lost += track.tip.status == TipStatus::kLost;
  not_by_collar += track.doubt == TipDoubt::kNotByCollar;
  stood_still += track.doubt == TipDoubt::kStandsStill;
  if (track.doubt == TipDoubt::kNotByWrist) {
    ++not_by_wrist;
    from_wrist_m += track.from_wrist_m.norm();
    miss_m += track.from_wrist_m;
  }
  if (track.tip.status != TipStatus::kOk) return;
  ++ok;
  squared_direction_noise += track.direction_noise_rad * track.direction_noise_rad;
  if (track.source == TrackSource::kCorners) {
    ++by_corners;
    squared_rms_px += track.rms_px * track.rms_px;
  } else if (track.source == TrackSource::kPixels) {
    ++by_pixels;
    squared_noise_grey += track.noise_grey * track.noise_grey;
  }
}

void TrackSums::Score(const TipTrack& track, const Eigen::Vector3d& p_RE, const Pose& T_RC) {
  if (track.tip.status == TipStatus::kOk) score.Add(track.tip, p_RE, T_RC);
  if (track.tip.status == TipStatus::kPredicted) score_predicted.Add(track.tip, p_RE, T_RC);
}

double TrackSums::DirectionNoise_rad() const { return RootMean(squared_direction_noise, ok); }
double TrackSums::Corners_px() const { return RootMean(squared_rms_px, by_corners); }
double TrackSums::Noise_grey() const { return RootMean(squared_noise_grey, by_pixels); }

TrackTotals TrackSums::Totals(const std::string& family, bool camera_has_pose,
                              bool has_wrist) const {
  return {.frames = frames,
          .ok = ok,
          .predicted = predicted,
          .lost = lost,
          .tags = tags,
          .rms_px = Corners_px(),
          .family = family,
          .camera_has_pose = camera_has_pose,
          .has_wrist = has_wrist,
          .score = score,
          .not_by_wrist = not_by_wrist,
          .not_by_collar = not_by_collar,
          .stood_still = stood_still,
          .from_wrist_m = Mean(from_wrist_m, not_by_wrist),
          .steady_part = from_wrist_m > 0.0 ? miss_m.norm() / from_wrist_m : 0.0};
}

}  // namespace flextip
