// Terms of which effects are written, compiled and held against the terms.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/effects/discovered/term.h"

namespace flextip::diagnosis {

/// A term with amplitudes that all differ, and the name of its effect.
inline std::pair<std::string, Term> SourceTerm(std::string name, TermTarget target, TermShape shape,
                                               TermVariable variable, std::vector<double> at) {
  Term term{target, shape, variable, std::move(at), {}, {}};
  term.amplitude = Eigen::MatrixXd::Zero(term.Inputs(), term.Columns());
  for (Eigen::Index i = 0; i < term.amplitude.size(); ++i)
    term.amplitude.reshaped()[i] = 1e-3 * double(i + 1);
  term.offset = 5e-4 * Eigen::VectorXd::Ones(term.Inputs());
  return {std::move(name), std::move(term)};
}

inline std::vector<std::pair<std::string, Term>> SourceTerms() {
  using T = TermTarget;
  using S = TermShape;
  using V = TermVariable;
  return {
      SourceTerm("gage_hum", T::kStrain, S::kPeriodic, V::kTime, {3.1}),
      SourceTerm("gage_limit", T::kStrain, S::kBand, V::kOwnValue, {0.01}),
      SourceTerm("wrist_play", T::kWristPosition, S::kPlay, V::kOwnValue, {0.0005}),
      SourceTerm("gage_glue", T::kStrain, S::kSmoothPlay, V::kOwnValue, {0.02}),
      SourceTerm("load_creep", T::kLoad, S::kRelaxing, V::kOwnValue, {0.8}),
      SourceTerm("em_metal", T::kEmPosition, S::kInversePower, V::kPosition, {0.2, 0.1, 0.05, 3.0}),
      SourceTerm("port_jump", T::kPort, S::kStep, V::kTime, {1.0, 0.1}),
      SourceTerm("soft_depth", T::kStiffness, S::kSmooth, V::kInsertionDepth, {0.1, 0.3}),
      SourceTerm("seen_slope", T::kVisionPosition, S::kLinear, V::kImagePosition, {}),
      SourceTerm("seen_bowl", T::kVisionPosition, S::kQuadratic, V::kImagePosition, {}),
      SourceTerm("seen_lens", T::kVisionPosition, S::kRadial, V::kImagePosition, {}),
      SourceTerm("em_late", T::kEmTime, S::kConstant, V::kTime, {}),
      SourceTerm("frame_jump", T::kVisionTime, S::kStep, V::kTime, {1.0, 0.1}),
      SourceTerm("load_plane", T::kShaftLoad, S::kPastPlane, V::kPosition, {0.1, 0.2, 0.9, 0.02}),
      SourceTerm("em_constant", T::kEmOrientation, S::kConstant, V::kTime, {})};
}

}  // namespace flextip::diagnosis
