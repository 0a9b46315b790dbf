// A discovered term as people read it: one direction, parameters in physical units, a sentence.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/effects/discovered/term.h"
#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// Returns the main direction of the term's amplitudes over the target's inputs, unit; its largest
/// component is positive but for a phase.
Eigen::VectorXd DirectionOf(const Term& term);

/// Returns amplitude and shape in physical units, along DirectionOf: amplitude_m, frequency_hz,
/// phase_rad and so on; deviations by `covariance` of what DiscoveredTerm fits and by `at_sd` of
/// the shape's parameters (both may be empty: zero).
std::vector<ReportedParameter> TermParameters(const Term& term,
                                              const Eigen::MatrixXd& covariance = {},
                                              const std::vector<double>& at_sd = {});

/// Returns a sentence without its full stop: "the EM position swings by 0.82 mm at 1.312 Hz".
std::string TextOf(const Term& term);

}  // namespace flextip::diagnosis
