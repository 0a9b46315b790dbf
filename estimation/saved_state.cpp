#include "estimation/saved_state.h"

namespace flextip {

void VisitState(TipObservation& tip, StateText& state) {
  state(tip.status);
  state(tip.p_RE);
  state(tip.covariance_m2);
  state(tip.d_RE);
}

void VisitState(EmMeasurement& em, StateText& state) {
  state(em.T_RS);
  state(em.distance_from_tip_m);
  state(em.position_noise_m);
  state(em.orientation_noise_rad);
}

void VisitState(StrainMeasurement& strain, StateText& state) {
  state(strain.moments_Nm);
  for (double& station_m : strain.station_from_wrist_m) state(station_m);
  state(strain.moment_noise_Nm);
}

void VisitState(LoadMeasurement& load, StateText& state) {
  state(load.f_tip_N);
  state(load.force_noise_N);
}

void VisitState(Measurements& z, StateText& state) {
  state(z.p_RW);
  state(z.wrist_position_noise_m);
  state(z.R_RW);
  state(z.wrist_orientation_noise_rad);
  state(z.tip);
  state(z.tip_direction_noise_rad);
  state(z.em);
  state(z.port_direction);
  state(z.port_direction_noise_rad);
  state(z.strain);
  state(z.load);
}

void VisitState(ShaftProblem& problem, StateText& state) {
  state(problem.rod.rod);
  state(problem.rod.effects);
  state(problem.tip_compliance_m_N);
}

void VisitState(ShaftChange& change, StateText& state) {
  state(change.stiffness_scale);
  state(change.length_delta_m);
  state(change.weight_N_m);
  state(change.wrist_shift_m);
  state(change.wrist_misread_m);
  state(change.port_shift_m);
  state(change.effects);
  state(change.tip_compliance_m_N);
  state(change.wrist_play_m);
}

void VisitState(ShaftModel& model, StateText& state) {
  Instrument& instrument = model.instrument;
  state(instrument.length_m);
  state(instrument.outer_diameter_m);
  state(instrument.bending_stiffness_Nm2);
  state(instrument.mass_per_length_kg_m);
  state(instrument.stiffness_taper);
  state(model.p_RP);
  state(model.weight_N_m);
  state(model.f_tip_N);
  state(model.tissue_stiffness_N_m);
  state(model.force_known);
  state(model.effects);
  state(model.tip_compliance_m_N);
  state(model.wrist_shift_m);
  state(model.wrist_misread_m);
  state(model.wrist_play_m);
  BeamFit& beam = model.beam;
  state(beam.status);
  state(beam.F_p_over_EI);
  state(beam.a);
  state(beam.length_m);
  state(beam.R_RM);
  state(beam.covariance);
}

}  // namespace flextip
