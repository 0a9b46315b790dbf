// Chapter 3's beam at an insertion depth, its Jacobians as printed and as corrected, and what noisy
// sensors make of it. All in the model frame of the true beam: wrist at the origin, x along the
// chord. Private to reproduction.
#pragma once

#include <Eigen/Dense>

namespace flextip::reproduction {

/// Which derivative of the beam stands for the flexion Jacobian.
enum class FlexionForm {
  kPrinted,    ///< (3.15)-(3.26) as printed, in metres
  kPortForce,  ///< corrected, F_p held constant (the thesis's assumption)
  kTipForce,   ///< corrected, F_t held constant
};
inline constexpr FlexionForm kFlexionForms[] = {FlexionForm::kPrinted, FlexionForm::kPortForce,
                                                FlexionForm::kTipForce};
const char* Name(FlexionForm form);

/// A bent shaft: its length and normalized tip force.
struct BentShaft {
  double length_m = 0.355;
  double F_t_over_EI = 3.0;  ///< 1/m^2, on the tip along -y
};

struct BeamState {
  double length_m = 0.0;
  double F = 0.0;    ///< F_p/EI of (3.1): negative where the port pushes along +y
  double a = 0.0;    ///< port along the chord (m)
  double phi = 0.0;  ///< angle of the chord in the world (rad)
  Eigen::Vector2d p_wrist = Eigen::Vector2d::Zero();

  Eigen::Vector2d Port() const;  ///< (3.8)
  Eigen::Vector2d Tip() const;   ///< (3.6)
};

/// The beam with its tip at `depth_m` from the port, 0 < depth < length.
BeamState BeamAtDepth(const BentShaft& shaft, double depth_m);

/// d tip / d wrist; needs 0 < a < length but for the printed form, which takes what it gets.
Eigen::Matrix2d FlexionJacobian(FlexionForm form, const BeamState& state);
/// The lever's (3.27) for the same wrist and port, and its tip.
Eigen::Matrix2d LeverJacobian(const BeamState& state);
Eigen::Vector2d LeverTip(const BeamState& state);

/// What the sensors say: wrist x, y and tip x, y (m), angles at wrist and tip (rad); or their
/// errors.
using BeamReadings = Eigen::Matrix<double, 6, 1>;

BeamReadings ReadingsOf(const BeamState& state);
/// (3.8)-(3.14). `a` and `F` may be anything, not finite where the two slopes are equal.
BeamState EstimateBeam(const BeamReadings& readings, double length_m);

}  // namespace flextip::reproduction
