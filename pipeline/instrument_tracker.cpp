#include "pipeline/instrument_tracker.h"

#include "core/error.h"
#include "recording/resample.h"

namespace flextip {
namespace {

std::vector<CameraCalibration> Cameras(const Recording& recording) {
  std::vector<CameraCalibration> cameras{recording.cam0->calibration};
  if (recording.cam1) cameras.push_back(recording.cam1->calibration);
  return cameras;
}

}  // namespace

TipFollower::TipFollower(const Recording& recording, const TrackerOptions& options, bool with_model)
    : recording_(&recording),
      beyond_collar_(FreeEndOf(recording.instrument, *recording.tags0, recording.gravity_m_s2)),
      tracker_(Cameras(recording), *recording.tags0, options) {
  if (with_model && recording.wrist0) model_.emplace(recording);
}

TipFollower::Bend TipFollower::BendAt(TimeNs t_ns, const Pose& T_RE) const {
  if (!recording_->load0 || !(beyond_collar_.bending_stiffness_Nm2 > 0)) return {};
  const auto f_tip_N = LoadAt(*recording_->load0, t_ns);
  if (!f_tip_N) return {};
  const double sd_m = FreeEndCompliance(beyond_collar_) * recording_->load0->force_noise_N;
  const Eigen::Vector3d d = T_RE.R.col(0);
  return {T_RE.Inverse() * BendFreeEnd(beyond_collar_, *f_tip_N, T_RE),
          sd_m * sd_m * (Eigen::Matrix3d::Identity() - d * d.transpose())};
}

TipTrack TipFollower::Follow(const FrameSet& frames) {
  auto expected = model_ ? model_->Predict(frames.t_ns) : std::nullopt;
  if (expected) {
    expected->T_RE = expected->T_RE * BendAt(frames.t_ns, expected->T_RE).T_EE.Inverse();
  }
  TipTrack track = tracker_.Track(frames.Pointers(), frames.t_ns, expected);
  if (track.tip.status == TipStatus::kOk) {
    const Bend bend = BendAt(frames.t_ns, track.T_RE);
    track.T_RE = track.T_RE * bend.T_EE;
    track.tip.p_RE = track.T_RE.p;
    track.tip.d_RE = track.T_RE.R.col(0);
    track.tip.covariance_m2 += bend.covariance_m2;
    track.covariance.bottomRightCorner<3, 3>() += bend.covariance_m2;
    if (model_) model_->Seen(frames.t_ns, track.T_RE, track.covariance);
  } else if (track.tip.status == TipStatus::kPredicted && expected) {
    const Bend bend = BendAt(frames.t_ns, expected->T_RE);
    track.tip.p_RE += expected->T_RE.R * bend.T_EE.p;
    track.tip.covariance_m2 += bend.covariance_m2;
  }
  return track;
}

void TipFollower::VisitState(StateText& state) {
  state(tracker_);
  if (state.IsThere(model_.has_value()) != model_.has_value()) {
    throw InputError("saved state: of a run with another --no-model");
  }
  if (model_) state(*model_);
  state.Finish();
}

std::string TipFollower::State() {
  StateText state;
  VisitState(state);
  return state.Text();
}

void TipFollower::SetState(const std::string& text) {
  StateText state(text);
  VisitState(state);
}

}  // namespace flextip
