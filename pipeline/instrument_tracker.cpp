#include "pipeline/instrument_tracker.h"

#include "core/error.h"

namespace flextip {

InstrumentTrackerSetup TrackerSetupOf(const Recording& recording, const TrackerOptions& options,
                                      bool with_model) {
  InstrumentTrackerSetup setup;
  setup.instrument = recording.instrument;
  setup.p_RP = recording.p_RP;
  setup.gravity_m_s2 = recording.gravity_m_s2;
  setup.cameras.push_back(recording.cam0->calibration);
  if (recording.cam1) setup.cameras.push_back(recording.cam1->calibration);
  setup.collar = *recording.tags0;
  setup.tracker = options;
  setup.with_model = with_model && recording.wrist0.has_value();
  setup.camera_has_pose = recording.cam0->has_T_RC;
  return setup;
}

InstrumentTracker::InstrumentTracker(const InstrumentTrackerSetup& setup)
    : beyond_collar_(FreeEndOf(setup.instrument, setup.collar, setup.gravity_m_s2)),
      tracker_(setup.cameras, setup.collar, setup.tracker) {
  if (!setup.with_model) return;
  model_.emplace(setup.instrument, setup.p_RP, setup.gravity_m_s2);
  if (setup.camera_has_pose) range_.emplace(setup.instrument, setup.p_RP, setup.gravity_m_s2);
}

InstrumentTracker::Bend InstrumentTracker::BendUnder(
    const std::optional<Sample<LoadMeasurement>>& load, const Pose& T_RE) const {
  if (!load || !(beyond_collar_.bending_stiffness_Nm2 > 0)) return {};
  const double sd_m = FreeEndCompliance(beyond_collar_) * load->value.force_noise_N;
  const Eigen::Vector3d d = T_RE.R.col(0);
  return {T_RE.Inverse() * BendFreeEnd(beyond_collar_, load->value.f_tip_N, T_RE),
          sd_m * sd_m * (Eigen::Matrix3d::Identity() - d * d.transpose())};
}

TipTrack InstrumentTracker::Follow(std::span<const Image* const> pictures, TimeNs t_ns,
                                   const SensorReadings& readings) {
  const std::optional<Measurements> measured = model_ ? Gather(readings) : std::nullopt;
  auto expected = model_ ? model_->Predict(t_ns, measured) : std::nullopt;
  auto allowed = range_ ? range_->At(t_ns, measured) : std::nullopt;
  for (auto* tip : {&expected, &allowed}) {
    if (*tip) (*tip)->T_RE = (*tip)->T_RE * BendUnder(readings.load, (*tip)->T_RE).T_EE.Inverse();
  }
  const std::vector<const Image*> images(pictures.begin(), pictures.end());
  const bool stand_still = still_.Look(images, measured);
  TipTrack track = stand_still ? tracker_.Carry(t_ns, expected)
                               : tracker_.Track(images, t_ns, expected, allowed);
  if (stand_still) track.doubt = TipDoubt::kStandsStill;
  if (track.tip.status == TipStatus::kOk) {
    const Bend bend = BendUnder(readings.load, track.T_RE);
    track.T_RE = track.T_RE * bend.T_EE;
    track.tip.p_RE = track.T_RE.p;
    track.tip.d_RE = track.T_RE.R.col(0);
    track.tip.covariance_m2 += bend.covariance_m2;
    track.covariance.bottomRightCorner<3, 3>() += bend.covariance_m2;
    if (model_) model_->Seen(t_ns, measured, track.T_RE, track.covariance);
  } else if (track.tip.status == TipStatus::kPredicted && expected) {
    const Bend bend = BendUnder(readings.load, expected->T_RE);
    track.tip.p_RE += expected->T_RE.R * bend.T_EE.p;
    track.tip.covariance_m2 += bend.covariance_m2;
  }
  return track;
}

void InstrumentTracker::VisitState(StateText& state) {
  state(tracker_);
  if (state.IsThere(model_.has_value()) != model_.has_value()) {
    throw InputError("saved state: of a run with another choice of the shaft model");
  }
  if (model_) state(*model_);
  if (range_) state(*range_);
  state(still_);
  state.Finish();
}

std::string InstrumentTracker::State() {
  StateText state;
  VisitState(state);
  return state.Text();
}

void InstrumentTracker::SetState(const std::string& text) {
  StateText state(text);
  VisitState(state);
}

}  // namespace flextip
