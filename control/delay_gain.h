// The gain that a loop with an uncertain delay may have.
#pragma once

namespace flextip {

/// How late the tip is, for the loop's gain.
struct DelayUncertainty {
  double rate_hz = 0.0;  ///< of the cycle; 0: nothing is known, and the gain stays as it is
  double sd_s = 0.0;     ///< of the tip's latency, which itself is taken off
  double deviations = 2.0;
  double model_error = 0.3;  ///< largest |1 - J_true / J_model| of the tip by the wrist
};

/// Returns the largest gain in (0, `gain`] for which the loop stays stable, whatever the delay is
/// off by within the stated deviations and the Jacobian within the model error.
///
/// The loop carries the late tip forward by what the wrist did since. With the delay known, the
/// wrist moves by w_{k+1} = w_k + g (goal - tip), and only the model's error E comes back, late,
/// through T(z) = g / (z - 1 + g). A delay that is off by n cycles adds (1 + E) (z^-n - 1). By the
/// small-gain theorem the loop is stable where
///   |T| (E + (1 + E) |z^-n - 1|) < 1 on the unit circle,
/// for every delay. (Doyle, Francis, Tannenbaum, Feedback Control Theory, 1992, 4.2; for E and T
/// that turn with the direction, E bounds the largest singular value.)
double GainUnderDelay(double gain, const DelayUncertainty& delay);

}  // namespace flextip
