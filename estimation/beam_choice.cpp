#include "estimation/beam_choice.h"

#include <algorithm>
#include <cmath>

#include "estimation/moment_fit.h"
#include "estimation/slope_fit.h"

namespace flextip {
namespace {

bool SeesTip(const Measurements& z) { return z.tip && z.tip->status == TipStatus::kOk; }

/// The chord's direction is known as well as the positions at its ends.
double ChordNoise(const Measurements& z, double length_m) {
  const double tip_m = std::sqrt(z.tip->covariance_m2.trace() / 3.0);
  return std::hypot(z.wrist_position_noise_m, tip_m) / length_m;
}

BeamFit FromSlopes(const Measurements& z, double length_m) {
  SlopeNoise noise;
  noise.wrist_rad = z.wrist_orientation_noise_rad;
  noise.chord_rad = ChordNoise(z, length_m);
  if (z.em) {
    noise.tip_rad = z.em->orientation_noise_rad;
    return FitFromSlopes(z.p_RW, z.tip->p_RE, z.R_RW->col(0), z.em->T_RS.R.col(0), length_m, noise);
  }
  noise.tip_rad = z.tip_direction_noise_rad;
  return FitFromSlopes(z.p_RW, z.tip->p_RE, z.R_RW->col(0), *z.tip->d_RE, length_m, noise);
}

BeamFit FromMoments(const Measurements& z, const Instrument& instrument) {
  return FitFromMoments(z.p_RW, z.tip->p_RE, MomentsInR(*z.strain, *z.R_RW),
                        instrument.bending_stiffness_Nm2, instrument.length_m);
}

/// Near-straight shafts and biased tips make the closed forms put the port anywhere. Unlike the
/// thesis's system this one has a registered port: a fit far from it is not believed.
constexpr double kPortAgreement = 0.05;  // of the length

bool Believable(const BeamFit& fit, const Measurements& z, const ShaftModel& model) {
  if (!fit.IsUsable()) return false;
  const double registered = (model.p_RP - z.p_RW).norm();
  return std::abs(fit.a - registered) < kPortAgreement * fit.length_m;
}

}  // namespace

BeamFit ChooseBeamFit(const Measurements& z, const Instrument& instrument, const ShaftModel& model,
                      bool use_positions) {
  BeamFit fit;
  if (use_positions && SeesTip(z) && z.R_RW) {
    if (z.em || z.tip->d_RE) fit = FromSlopes(z, instrument.length_m);
    if (!Believable(fit, z, model) && z.strain) fit = FromMoments(z, instrument);
  }
  if (Believable(fit, z, model)) return fit;
  return SolveBeam(z.p_RW, model.p_RP, model.f_tip_N, instrument.bending_stiffness_Nm2,
                   instrument.length_m);
}

}  // namespace flextip
