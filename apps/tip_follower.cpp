#include "apps/tip_follower.h"

#include "core/error.h"

namespace flextip {
namespace {

std::vector<CameraCalibration> Cameras(const Recording& recording) {
  std::vector<CameraCalibration> cameras{recording.cam0->calibration};
  if (recording.cam1) cameras.push_back(recording.cam1->calibration);
  return cameras;
}

}  // namespace

TipFollower::TipFollower(const Recording& recording, const TrackerOptions& options, bool with_model)
    : tracker_(Cameras(recording), *recording.tags0, options) {
  if (with_model && recording.wrist0) model_.emplace(recording);
}

TipTrack TipFollower::Follow(const FrameSet& frames) {
  const auto expected = model_ ? model_->Predict(frames.t_ns) : std::nullopt;
  TipTrack track = tracker_.Track(frames.Pointers(), frames.t_ns, expected);
  if (model_ && track.tip.status == TipStatus::kOk) {
    model_->Seen(frames.t_ns, track.T_RE, track.covariance);
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
